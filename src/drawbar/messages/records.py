"""Records: the bytes of messages, of fixed size with a checksum (docs/messages.md).

Every record is little-endian without padding: the header, the fields of its kind in the order of their declaration,
those of a part where the part is declared, and the CRC-32 (zlib) of all bytes before it. `encode` makes one of a
message; `decode` returns the message, or the `Flaw` for which it is refused. Pure; without numpy, like the messages, so
that the gate can use them.
"""

import math
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum, IntEnum
from functools import cache
from operator import attrgetter
from typing import Any, get_args, get_origin, get_type_hints

from drawbar.messages.base import Message
from drawbar.messages.fields import Cell
from drawbar.messages.kinds import KIND_OF, KINDS, Kind

MARK = 0x4244
"""first two bytes of every record: "DB" """
VERSION = 7
"""of the layouts; a record of another version is refused"""


class Flaw(Enum):
    """Why bytes are refused as a record."""

    LENGTH = "it does not have the length of its kind"
    MARK = "it does not begin with the mark and version of these records"
    KIND = "its kind is none of those expected here"
    CHECKSUM = "its checksum is wrong"
    VALUE = "one of its enumerations has a value that is not declared"
    NOT_FINITE = "one of its numbers is infinite, or is missing where it must not be"


_HEADER, _CHECKSUM = struct.Struct("<HBB"), struct.Struct("<I")


@dataclass(frozen=True, slots=True)
class Layout:
    """How the messages of one kind lie in their records."""

    body: struct.Struct
    """all fields, without mark, version, kind and checksum"""
    cells: tuple[tuple[str, Cell, type[IntEnum] | None], ...]
    """name (of a part's field: part.field), cell and, where it is one, enumeration of each field"""

    @property
    def size(self) -> int:
        """Length of a record, bytes."""
        return _HEADER.size + self.body.size + _CHECKSUM.size


def _layout(kind: type[Message]) -> Layout:
    cells = tuple(_cells(kind))
    return Layout(struct.Struct("<" + "".join(cell.code for _, cell, _ in cells)), cells)


@cache
def _parts(kind: type) -> dict[str, type | None]:
    """Return the class of each field of a message that is a part of it, None of one that lies in a cell."""
    hints: dict[str, type] = get_type_hints(kind)
    return {each.name: hints[each.name] if is_dataclass(hints[each.name]) else None for each in fields(kind)}


def _cells(kind: type) -> Iterator[tuple[str, Cell, type[IntEnum] | None]]:
    hints = get_type_hints(kind, include_extras=True)
    for name, part in _parts(kind).items():
        if part is None:
            yield name, *_cell(hints[name])
        else:
            yield from ((f"{name}.{inner}", cell, enumeration) for inner, cell, enumeration in _cells(part))


def _cell(hint: Any) -> tuple[Cell, type[IntEnum] | None]:
    declared, cell = get_args(hint)
    return cell, None if get_origin(declared) or not issubclass(declared, IntEnum) else declared


LAYOUTS = {kind: _layout(cls) for kind, cls in KINDS.items()}
"""how the messages of each kind lie in their records"""


def encode(message: Message) -> bytes:
    """Return the record of a message. Numbers that are not finite are written as they are; `decode` refuses them.

    Raises:
        struct.error: a number is beyond the range of its field.
    """
    kind = KIND_OF[type(message)]
    place = LAYOUTS[kind]
    values: list[Any] = []
    for name, cell, _ in place.cells:
        value = attrgetter(name)(message)
        values += value if len(cell.code) > 1 else [value]
    record = _HEADER.pack(MARK, VERSION, kind) + place.body.pack(*values)
    return record + _CHECKSUM.pack(zlib.crc32(record))


def decode(data: bytes, *expected: type[Message]) -> Message | Flaw:
    """Return the message in a record, if its class is one of those expected, else why it is refused."""
    if len(data) < _HEADER.size + _CHECKSUM.size:
        return Flaw.LENGTH
    mark, version, kind = _HEADER.unpack_from(data)
    if (mark, version) != (MARK, VERSION):
        return Flaw.MARK
    message = next((cls for cls in expected if KIND_OF[cls] == kind), None)
    if message is None:
        return Flaw.KIND
    place = LAYOUTS[Kind(kind)]
    if len(data) != place.size:
        return Flaw.LENGTH
    if _CHECKSUM.unpack_from(data, len(data) - _CHECKSUM.size)[0] != zlib.crc32(data[: -_CHECKSUM.size]):
        return Flaw.CHECKSUM
    return _read(message, place, list(place.body.unpack_from(data, _HEADER.size)))


def _read(message: type[Message], place: Layout, numbers: list[Any]) -> Message | Flaw:
    values = list[Any]()
    for _, cell, enumeration in place.cells:
        if len(cell.code) > 1:
            count = int(cell.code[:-1])
            values.append(tuple(numbers[:count]))
            numbers = numbers[count:]
            continue
        value = numbers.pop(0)
        if cell.code == "d" and not (math.isfinite(value) or (cell.may_miss and math.isnan(value))):
            return Flaw.NOT_FINITE
        if enumeration is not None:
            if value not in enumeration.__members__.values():
                return Flaw.VALUE
            value = enumeration(value)
        values.append(value)
    made: Message = _made(message, iter(values))
    return made


def _made(kind: type, values: Iterator[Any]) -> Any:
    """Return a message, or a part of one, of the values of all its fields in their order."""
    return kind(**{name: _made(part, values) if part else next(values) for name, part in _parts(kind).items()})
