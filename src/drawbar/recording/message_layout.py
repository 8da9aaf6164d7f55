"""Layout of the messages between processes in a log: CDR, as steps are (step/layout.py), by a ROS 2 definition there.

A log's own definitions describe its messages, so that logs of versions with other fields can be read.
"""

from collections.abc import Callable, Iterator
from dataclasses import is_dataclass
from functools import cache
from operator import attrgetter
from struct import Struct
from typing import Any, get_args, get_type_hints

from drawbar.declared_words import declared_words
from drawbar.messages import KIND_OF, Kind, Message
from drawbar.messages.fields import Cell
from drawbar.messages.records import LAYOUTS
from drawbar.step.layout import HEAD, cells_of, sections

_TYPES = {"B": "uint8", "H": "uint16", "I": "uint32", "i": "int32", "Q": "uint64", "d": "float64"}


def message_schema(kind: type[Message]) -> str:
    """Return the definition of a kind of messages, with the words about each field."""
    texts: dict[Any, str] = {}
    _describe(kind, texts)
    return sections(texts)


def _describe(kind: Any, texts: dict[Any, str]) -> None:
    """Add the definition of a message, or of a part of one, behind those that it consists of."""
    lines, words = list[str](), declared_words(kind)
    for name, hint in get_type_hints(kind, include_extras=True).items():
        if is_dataclass(hint):
            lines.append(f"drawbar/{hint.__name__} {name}\n")  # type: ignore[union-attr]
            if not any(hint is each for each in texts):
                _describe(hint, texts)
        else:
            lines.append(f"{_declared(get_args(hint)[1])} {name}  # {words[name]}\n")
    texts[kind] = "".join(lines)


def _declared(cell: Cell) -> str:
    count, code = cell.code[:-1], cell.code[-1]
    return f"{_TYPES[code]}[{count}]" if count else _TYPES[code]


def pack_message(message: Message) -> bytes:
    """Return the bytes of a message as its definition says. Raises struct.error: a number is beyond its range."""
    names, struct = _packing(KIND_OF[type(message)])
    return HEAD + struct.pack(*_numbers(message, names))


def _numbers(message: Message, names: tuple[str, ...]) -> Iterator[Any]:
    for value in attrgetter(*names)(message):
        if isinstance(value, tuple):
            yield from value
        else:
            yield value


@cache
def _packing(kind: Kind) -> tuple[tuple[str, ...], Struct]:
    cells = LAYOUTS[kind].cells
    return tuple(name for name, _, _ in cells), Struct("".join(cell.code for _, cell, _ in cells))


@cache
def message_reader(schema: str) -> Callable[[bytes], dict[str, Any]]:
    """Return what makes a dictionary of a message by its definition; parts are dictionaries, arrays are tuples.

    It raises struct.error where a message is shorter. Raises ValueError or KeyError: the definition is none.
    """
    cells = cells_of(schema)
    struct = Struct("".join(f"{cell.length or ''}{cell.code}" for cell in cells.values()))

    def read(data: bytes) -> dict[str, Any]:
        numbers, at, made = struct.unpack_from(data, len(HEAD)), 0, dict[str, Any]()
        for name, cell in cells.items():
            *parts, leaf = name.split(".")
            part = made
            for each in parts:
                part = part.setdefault(each, {})
            part[leaf] = numbers[at : at + cell.length] if cell.length else numbers[at]
            at += max(1, cell.length)
        return made

    return read
