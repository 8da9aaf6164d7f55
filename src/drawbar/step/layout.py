"""Layout of a recorded step: where each number of a StepRecord lies in C's struct drawbar_record.

The bytes of that structure are what a log holds of a step. They are also what ROS 2 calls CDR, which Foxglove and ROS
tools read by the schema here, a ROS 2 message definition: numbers one after the other, each aligned to its size. A
log's own schema describes the layout of its steps, so that logs of versions with other signals can be read.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from functools import cache
from operator import attrgetter
from struct import Struct, calcsize
from struct import error as StructError  # noqa: N812 -- a class
from types import UnionType
from typing import Any, NamedTuple, get_type_hints

import numpy as np
from numpy.typing import NDArray

from drawbar.errors import DrawbarError, SignalError
from drawbar.signals import Array, Quantity, StepRecord
from drawbar.signals.layout import Members, base_of, members_of, note_of

_DEVIATIONS = 4
"""numbers for which there is room where fewer may be known: DEVIATIONS_RECORDED"""
_CODES = {"float64": "d", "float32": "f", "int32": "i", "uint8": "B", "uint16": "H", "uint32": "I", "uint64": "Q"}
HEAD = b"\0\1\0\0"
"""of each message, before the step's own bytes: it is CDR, and the smallest byte of a number comes first"""
RULE = "=" * 80
_PACKAGE = "drawbar/"


class Cell(NamedTuple):
    """A number of a recorded step, or some that follow each other."""

    code: str
    """of module struct"""
    length: int
    """of the array; 0: it is a number alone"""
    offset: int
    """bytes"""


@cache
def step_schema(stages: int) -> str:
    """Return the definition of a step whose plans have so many stages, as a ROS 2 message."""
    texts: dict[Any, str] = {}
    _describe(StepRecord, stages, texts)
    return sections(texts)


def sections(texts: dict[Any, str]) -> str:
    """Return a message's definition, the last of these by class, with those that it consists of behind it."""
    first, *others = reversed(texts.items())
    return "".join([first[1], *(f"{RULE}\nMSG: {_PACKAGE}{kind.__name__}\n{text}" for kind, text in others)])


def _describe(kind: Any, stages: int, texts: dict[Any, str]) -> None:
    """Add the definition of a signal behind those that it consists of."""
    lines, counts = list[str](), list[str]()
    for name, hint, words in members_of(kind):
        base, array, quantity = base_of(hint), note_of(hint, Array), note_of(hint, Quantity)
        if is_dataclass(base):
            if base not in texts:
                _describe(base, stages, texts)
            declared = f"{_PACKAGE}{base.__name__}"  # type: ignore[union-attr]
        elif array:
            declared = _array(array, stages)
        else:
            declared = "float64" if base is float else "int32"
        unit = quantity.unit if quantity and quantity.unit != "1" else ""
        comment = ", ".join(filter(None, (words, unit)))
        lines.append(f"{declared} {name}  # {comment}" if comment else f"{declared} {name}")
        if array and array.counted:
            counts.append(f"int32 {array.rows}  # how many of {name} are known")
    texts[kind] = "".join(f"{line}\n" for line in lines + counts)


def _array(array: Array, stages: int) -> str:
    if array.counted:
        return f"float64[{_DEVIATIONS}]"
    if not array.rows:
        return f"float64[{array.columns}]"
    rows = {"N": stages, "N + 1": stages + 1}[array.rows]
    return f"float32[{rows * max(1, array.columns)}]"


def cells_of(schema: str) -> dict[str, Cell]:
    """Return where a definition puts each number, by dotted names. Raises ValueError: it is none."""
    definitions = {}
    for section in f"MSG: \n{schema}".split(f"{RULE}\n"):
        name, *lines = section.splitlines()
        members = [line.split("#")[0].split() for line in lines]
        definitions[name.removeprefix("MSG: ").removeprefix(_PACKAGE)] = [pair for pair in members if pair]
    cells, end = dict[str, Cell](), 0
    for name, code, count in _flat(definitions, ""):
        size = calcsize(code)
        begin = -(-end // size) * size
        cells[name] = Cell(code, count, begin)
        end = begin + size * max(1, count)
    return cells


def _flat(definitions: dict[str, list[list[str]]], kind: str, prefix: str = "") -> Iterator[tuple[str, str, int]]:
    for declared, name in definitions[kind]:
        base, _, count = declared.removesuffix("]").partition("[")
        if base in _CODES:
            yield prefix + name, _CODES[base], int(count or 0)
        else:
            yield from _flat(definitions, base.removeprefix(_PACKAGE), f"{prefix}{name}.")


class StepLayout:
    """How steps lie in the bytes that one schema describes."""

    def __init__(self, schema: str) -> None:
        """Read a schema. Raises ValueError or KeyError: it is none of a step."""
        self.cells = cells_of(schema)
        last = max(self.cells.values(), key=lambda cell: cell.offset)
        self.size = -(-(last.offset + calcsize(last.code) * max(1, last.length)) // 8) * 8
        """bytes of a step"""
        self._numbers = [name for name, cell in self.cells.items() if not cell.length]
        self._struct = Struct("".join(_format(cell, read=not cell.length) for cell in self.cells.values()))

    @classmethod
    def of(cls, stages: int) -> "StepLayout":
        """Return the layout of this drawbar's steps whose plans have so many stages."""
        return _layout(step_schema(stages))

    @classmethod
    def of_schema(cls, schema: str) -> "StepLayout":
        """Return the layout that a schema describes. Raises ValueError or KeyError: it is none of a step."""
        return _layout(schema)

    @classmethod
    def of_size(cls, size: int) -> "StepLayout":
        """Return the layout of this drawbar's steps that have so many bytes. Raises ValueError: none has."""
        least = cls.of(1)
        stages, rest = divmod(size - least.size, cls.of(2).size - least.size)
        if rest or stages < 0:
            raise ValueError(f"no step has {size} bytes")
        return cls.of(1 + stages)

    def body(self, message: bytes) -> bytes:
        """Return the bytes of a step out of a message, which begins with HEAD. Raises ValueError: it is none."""
        if len(message) != len(HEAD) + self.size:
            raise ValueError(f"a step has {len(message) - len(HEAD)} bytes instead of {self.size}")
        return message[len(HEAD) :]

    def reader(self, *given: str) -> Callable[..., StepRecord]:
        """Return what makes a step of its bytes; some of its signals may be given as further arguments instead.

        A number that the schema lacks has its default. DrawbarError: it has none.
        """
        read = {name: not cell.length and name.partition(".")[0] not in given for name, cell in self.cells.items()}
        unpack = Struct("".join(_format(cell, read=read[name]) for name, cell in self.cells.items())).unpack_from
        places = {name: place for place, name in enumerate(name for name in self.cells if read[name])}
        names: dict[str, Any] = {"np": np, "isnan": math.isnan, "unpack": unpack}
        made = _Construction(self.cells, places, names).of(StepRecord, given=given)
        takes = ", ".join(["data", *given])
        views = "np.frombuffer(data), np.frombuffer(data, np.float32)"
        source = f"lambda {takes}: (lambda numbers, doubles, floats: {made})(unpack(data), {views})"
        return eval(source, names)  # type: ignore[no-any-return]

    def pack(self, record: StepRecord) -> bytes:
        """Return the bytes of a step. Raises SignalError: a value is no number, or an array has another size."""
        data, absent = bytearray(self.size), record.truth is None
        known = [name for name in self._numbers if not name.endswith(".deviations")]
        try:
            given = {name: attrgetter(name)(record) for name in known if not (absent and name.startswith("truth."))}
            for body in ("tractor", "trailer"):
                given[f"plan.{body}.deviations"] = len(getattr(record.plan, body).deviation)
            numbers = [
                int(given[name]) if self.cells[name].code == "i" else given.get(name, math.nan)
                for name in self._numbers
            ]
            self._struct.pack_into(data, 0, *numbers)
            for name, cell in self.cells.items():
                if cell.length:
                    self._put(data, name, cell, attrgetter(name)(record))
        except (StructError, AttributeError, TypeError, ValueError) as error:
            raise SignalError(f"a StepRecord of numbers and arrays is needed; {error}.") from error
        return bytes(data)

    def _put(self, data: bytearray, name: str, cell: Cell, values: Any) -> None:
        """Write an array into the bytes of a step."""
        room = np.frombuffer(data, cell.code, cell.length, cell.offset)
        flat = np.asarray(values, dtype=np.float64).ravel()
        counted = f"{name}s" in self.cells
        if flat.size > cell.length or (flat.size < cell.length and not counted):
            raise ValueError(f"{name} holds {flat.size} numbers instead of {cell.length}")
        room[:] = math.nan
        with np.errstate(over="ignore"):
            room[: flat.size] = flat

    def holds(self, name: str) -> bool:
        """Return whether a step has a number of this name."""
        return (name.rpartition(".")[0] if name[-1].isdigit() else name) in self.cells

    def table(self, messages: Sequence[bytes], names: Sequence[str]) -> dict[str, NDArray[Any]]:
        """Return numbers of the steps in m messages by name, (m,) each; of an array by its place: `closest.2`.

        Raises ValueError: a message is no step.
        """
        places = [self._place(name) for name in names]
        form = {"names": list(names), "formats": [code for code, _ in places], "offsets": [at for _, at in places]}
        kind: Any = np.dtype({**form, "itemsize": self.size})  # type: ignore[call-overload]
        rows = np.frombuffer(b"".join(map(self.body, messages)), kind)
        return {name: rows[name] for name in names}

    def _place(self, name: str) -> tuple[str, int]:
        """Return code and offset of a number."""
        head, _, index = name.rpartition(".")
        cell = self.cells[head if index.isdigit() else name]
        return cell.code, cell.offset + (int(index) * calcsize(cell.code) if index.isdigit() else 0)


_layout = cache(StepLayout)


def _format(cell: Cell, *, read: bool) -> str:
    """Return the format of a cell for module struct, which reads it or else skips it."""
    return cell.code if read else f"0{cell.code}{max(1, cell.length) * calcsize(cell.code)}x"


@dataclass(frozen=True, slots=True)
class _Construction:
    """Prints the expression that makes a signal of `numbers`, `doubles` and `floats`."""

    cells: dict[str, Cell]
    places: dict[str, int]
    """of single numbers among `numbers`"""
    names: dict[str, Any]
    """grows by what the expression names"""

    def of(self, kind: Any, prefix: str = "", given: Sequence[str] = ()) -> str:
        self.names[kind.__name__] = kind
        hints = get_type_hints(kind, include_extras=True)
        parts = [
            f"{field.name}={field.name if field.name in given else self._field(field, hints, prefix)}"
            for field in fields(kind)
        ]
        return f"{kind.__name__}({', '.join(parts)})"

    def _field(self, field: Field[Any], hints: dict[str, Any], prefix: str) -> str:
        hint, name = hints[field.name], prefix + field.name
        base, array = base_of(hint), note_of(hint, Array)
        if is_dataclass(base):
            made = self.of(base, f"{name}.")
            absent = isinstance(hint, UnionType) and f"{name}.time" in self.places
            return f"None if isnan(numbers[{self.places[f'{name}.time']}]) else {made}" if absent else made
        if name not in self.cells:
            return self._default(field, name)
        if array:
            return self._array(name, array)
        if base in (float, int):
            return f"numbers[{self.places[name]}]"
        self.names[base.__name__] = Members(base)
        return f"{base.__name__}[numbers[{self.places[name]}]]"

    def _array(self, name: str, array: Array) -> str:
        cell = self.cells[name]
        begin = cell.offset // calcsize(cell.code)
        if array.counted:
            count = self.places[f"{name.rpartition('.')[0]}.{array.rows}"]
            return f"doubles[{begin}:{begin} + numbers[{count}]]"
        if cell.code == "d":
            return f"doubles[{begin}:{begin + cell.length}]"
        shape = f".reshape(-1, {array.columns})" if array.columns else ""
        return f"floats[{begin}:{begin + cell.length}].astype(np.float64){shape}"

    def _default(self, field: Field[Any], name: str) -> str:
        if field.default is MISSING:
            raise DrawbarError(f"its steps lack {name}, which this drawbar needs; use the drawbar that wrote it")
        key = f"default_{name.replace('.', '_')}"
        self.names[key] = field.default
        return key


def packed(record: StepRecord) -> bytes:
    """Return the bytes of a step: those that C made of it, where it is C's."""
    data: bytes | None = record.__dict__.get("packed")
    return StepLayout.of(len(record.plan.tractor.steerings)).pack(record) if data is None else data


def made_of(record: StepRecord, data: bytes) -> StepRecord:
    """Return the record, which keeps the bytes that it was made of."""
    record.__dict__["packed"] = data
    return record


def unpacked(data: bytes) -> StepRecord:
    """Return the step of this drawbar that bytes hold. Raises ValueError: they are none."""
    return made_of(_own_reader(len(data))(data), data)


@cache
def _own_reader(size: int) -> Callable[[bytes], StepRecord]:
    return StepLayout.of_size(size).reader()
