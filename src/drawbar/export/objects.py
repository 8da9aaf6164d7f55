"""Object files: sizes of their sections, stack of each function, and which function calls which.

ELF (System V ABI, chapter 4), COFF (Microsoft's PE format, section 3) and 64-bit Mach-O (Apple's mach-o/loader.h),
little-endian, as far as needed here. The stack of a function comes from clang's `-fstack-size-section`, the calls
from the relocations of its section, which `-ffunction-sections` makes one per function. COFF and Mach-O have no such
records of the stack.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from struct import Struct, unpack_from

from drawbar.errors import CompilerError

_ALLOCATED, _WRITABLE, _EXECUTABLE = 2, 1, 4
"""flags of an ELF section"""
_NOTHING_STORED, _RELA, _REL, _SYMBOLS = 8, 4, 9, 2
"""types of ELF sections"""
_FUNCTION, _SECTION = 2, 3
"""types of ELF symbols"""
_CODE, _ZEROED, _DISCARDED, _WRITE = 0x20, 0x80, 0x800, 0x80000000
"""characteristics of a COFF section"""
_SEGMENT, _ZERO_FILLED, _INSTRUCTIONS = 0x19, 1, 0x80000400
"""a Mach-O file's command for a 64-bit segment; type, and attributes, of a section"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectFile:
    """One compiled unit."""

    sizes: Counter[str]
    """bytes of .text, .rodata, .data and .bss"""
    stack: dict[str, int]
    """bytes of each function's own frame, where they are known"""
    calls: dict[str, frozenset[str]]
    """what each function refers to: functions of this unit, or symbols that it does not define"""
    offered: frozenset[str]
    """functions that other units may call"""


def read_object(file: Path) -> ObjectFile:
    """Read an object file.

    Raises:
        CompilerError: neither ELF, 64-bit Mach-O nor COFF for x86-64.
    """
    data = file.read_bytes()
    if data[:4] == b"\x7fELF":
        return _Elf(data).read()
    if data[:2] == b"\x64\x86":
        return ObjectFile(sizes=_coff_sizes(data), stack={}, calls={}, offered=frozenset())
    if data[:4] == b"\xcf\xfa\xed\xfe":
        return ObjectFile(sizes=_mach_sizes(data), stack={}, calls={}, offered=frozenset())
    raise CompilerError(
        f"{file.name}: the compiler wrote an object file that is neither ELF, Mach-O nor COFF for x86-64."
    )


@dataclass(frozen=True, slots=True)
class _Section:
    kind: int
    flags: int
    offset: int
    size: int
    link: int
    info: int


@dataclass(frozen=True, slots=True)
class _Symbol:
    name: str
    kind: int
    visible: bool
    section: int


class _Elf:
    """An ELF object file with its tables."""

    def __init__(self, data: bytes) -> None:
        self._data, self._wide = data, data[4] == 2
        start, entry, count = (
            (*unpack_from("<Q", data, 40), *unpack_from("<HH", data, 58))
            if self._wide
            else (*unpack_from("<I", data, 32), *unpack_from("<HH", data, 46))
        )
        self._sections = [self._section(start + i * entry) for i in range(count)]
        self._symbols = list(self._read_symbols())
        self._functions = {s.section: s.name for s in self._symbols if s.kind == _FUNCTION and s.section}

    def _section(self, place: int) -> _Section:
        if self._wide:
            _, kind, flags, _, offset, size, link, info = unpack_from("<IIQQQQII", self._data, place)
        else:
            _, kind, flags, _, offset, size, link, info = unpack_from("<8I", self._data, place)
        return _Section(kind, flags, offset, size, link, info)

    def _read_symbols(self) -> Iterator[_Symbol]:
        table = next(section for section in self._sections if section.kind == _SYMBOLS)
        texts = self._sections[table.link].offset
        record = Struct("<IBBHQQ" if self._wide else "<IIIBBH")
        for place in range(table.offset, table.offset + table.size, record.size):
            fields = record.unpack_from(self._data, place)
            name, info, section = (fields[0], fields[1], fields[3]) if self._wide else (fields[0], fields[3], fields[5])
            end = self._data.index(b"\0", texts + name)
            yield _Symbol(self._data[texts + name : end].decode(), info & 15, info >> 4 == 1, section)

    def read(self) -> ObjectFile:
        return ObjectFile(
            sizes=self._sizes(),
            stack=dict(self._stack()),
            calls=self._calls(),
            offered=frozenset(s.name for s in self._symbols if s.kind == _FUNCTION and s.visible),
        )

    def _sizes(self) -> Counter[str]:
        sizes: Counter[str] = Counter()
        for section in self._sections:
            if section.flags & _ALLOCATED:
                sizes[_kind(section)] += section.size
        return sizes

    def _stack(self) -> Iterator[tuple[str, int]]:
        """Yield each function's frame from the records of an address (still zero) and a LEB128 number."""
        for section in self._sections:
            if section.kind == 1 and not section.flags & _ALLOCATED and section.link in self._functions:
                digits = self._data[section.offset + (8 if self._wide else 4) : section.offset + section.size]
                size = sum((digit & 0x7F) << 7 * i for i, digit in enumerate(digits))
                yield self._functions[section.link], size

    def _calls(self) -> dict[str, frozenset[str]]:
        called: dict[str, set[str]] = {name: set() for name in self._functions.values()}
        for section in self._sections:
            if section.kind in (_RELA, _REL) and section.info in self._functions:
                called[self._functions[section.info]] |= set(self._referred(section))
        return {name: frozenset(names - {name}) for name, names in called.items()}

    def _referred(self, section: _Section) -> Iterator[str]:
        width = (16 if self._wide else 8) + (section.kind == _RELA) * (8 if self._wide else 4)
        for place in range(section.offset, section.offset + section.size, width):
            index = (
                unpack_from("<Q", self._data, place + 8)[0] >> 32
                if self._wide
                else unpack_from("<I", self._data, place + 4)[0] >> 8
            )
            symbol = self._symbols[index]
            if symbol.kind == _SECTION:
                if symbol.section in self._functions:
                    yield self._functions[symbol.section]
            elif symbol.section == 0 or symbol.kind == _FUNCTION:
                yield symbol.name


def _kind(section: _Section) -> str:
    if section.flags & _EXECUTABLE:
        return ".text"
    if not section.flags & _WRITABLE:
        return ".rodata"
    return ".bss" if section.kind == _NOTHING_STORED else ".data"


def _coff_sizes(data: bytes) -> Counter[str]:
    sizes: Counter[str] = Counter()
    (count,), (optional,) = unpack_from("<H", data, 2), unpack_from("<H", data, 16)
    for place in range(20 + optional, 20 + optional + 40 * count, 40):
        (size,), (flags,) = unpack_from("<I", data, place + 16), unpack_from("<I", data, place + 36)
        if flags & _DISCARDED or data[place : place + 6] == b".debug":
            continue
        kind = ".text" if flags & _CODE else ".bss" if flags & _ZEROED else ".data" if flags & _WRITE else ".rodata"
        sizes[kind] += size
    return sizes


def _mach_sizes(data: bytes) -> Counter[str]:
    """Add up the sections of a Mach-O object file but for what only the linker and debuggers read."""
    sizes: Counter[str] = Counter()
    place = 32
    for _ in range(unpack_from("<I", data, 16)[0]):
        command, length = unpack_from("<II", data, place)
        count = unpack_from("<I", data, place + 64)[0] if command == _SEGMENT else 0
        for section in range(place + 72, place + 72 + 80 * count, 80):
            name, segment, _, size = unpack_from("<16s16sQQ", data, section)
            flags = unpack_from("<I", data, section + 64)[0]
            if segment.rstrip(b"\0") in (b"__TEXT", b"__DATA"):
                constant = segment.startswith(b"__TEXT") or name.startswith(b"__const")
                zeroed = ".bss" if flags & 0xFF == _ZERO_FILLED else ".data"
                sizes[".text" if flags & _INSTRUCTIONS else ".rodata" if constant else zeroed] += size
        place += length
    return sizes
