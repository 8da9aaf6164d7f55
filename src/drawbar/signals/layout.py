"""Layout: the bytes of a signal as C lays its structure out, derived from the signal's declaration."""

import ctypes
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from itertools import count
from numbers import Integral, Real
from operator import attrgetter
from reprlib import repr as short
from struct import Struct
from struct import error as StructError  # noqa: N812 -- a class
from types import NoneType, UnionType
from typing import Any, get_args, get_type_hints

from drawbar.declared_words import declared_words
from drawbar.errors import SignalError


class Layout:
    """The bytes of one C structure without arrays: packed from a signal's fields and unpacked into them."""

    def __init__(self, kind: Any) -> None:
        """Derive the layout from a signal's declaration."""
        self.kind = kind
        members = list(_leaves(kind))
        self.struct = Struct("".join("d" if issubclass(leaf, float) else "i" for _, leaf in members))
        self.size = self.struct.size + self.struct.size % 8
        self._values = attrgetter(*(place for place, _ in members))
        self._assemble = _assembler(kind)

    def pack(self, buffer: Any, signal: Any, offset: int = 0) -> None:
        """Write a signal into a buffer.

        Raises:
            SignalError: it is no such signal, or a value is no number or beyond its field.
        """
        try:
            self.struct.pack_into(buffer, offset, *self._values(signal))
        except (StructError, AttributeError) as error:
            raise self._refusal(signal, error) from error

    def _refusal(self, signal: Any, error: Exception) -> SignalError:
        """Return what finds the values that are no numbers."""
        if not isinstance(signal, self.kind):
            return SignalError(f"a drawbar {self.kind.__name__} is needed, got {short(signal)}.")
        given = zip(_leaves(self.kind), self._values(signal), strict=True)
        allowed = [(place, Real if issubclass(leaf, float) else Integral, value) for (place, leaf), value in given]
        wrong = [f"{place} = {value!r}" for place, number, value in allowed if not isinstance(value, number)]
        return SignalError(
            f"{self.kind.__name__}: {', '.join(wrong) or error}: a number is needed; NaN stands for one that "
            f"is missing, and a quality is a whole number."
        )

    def unpack(self, buffer: Any, offset: int = 0) -> Any:
        """Read a signal out of a buffer."""
        return self._assemble(self.struct.unpack_from(buffer, offset))

    def buffer(self) -> Any:
        """Return new memory for one structure, aligned, all zero."""
        return (ctypes.c_double * (self.size // 8))()


def _leaves(kind: Any, place: str = "") -> list[tuple[str, Any]]:
    """Return the dotted name and the type of each number, in C's order."""
    found: list[tuple[str, Any]] = []
    for name, hint, _ in members_of(kind):
        base = base_of(hint)
        found += _leaves(base, f"{place}{name}.") if is_dataclass(base) else [(f"{place}{name}", base)]
    return found


@cache
def _assembler(kind: Any) -> Any:
    """Return a function that makes a signal of its numbers in C's order: one expression, as quick as Python can."""
    names: dict[str, Any] = {}
    return eval(f"lambda numbers: {_construction(kind, names, count())}", names)


def _construction(kind: Any, names: dict[str, Any], places: Iterator[int]) -> str:
    """Return the call that makes a signal of `numbers`; the types and enumerations that it names are added to names."""
    made = is_dataclass(kind)
    names[kind.__name__] = kind if made else Members(kind)
    if not made:
        return f"{kind.__name__}[numbers[{next(places)}]]"
    given = []
    for name, hint, _ in members_of(kind):
        base = base_of(hint)
        plain = base in (float, int)
        given.append(f"{name}={f'numbers[{next(places)}]' if plain else _construction(base, names, places)}")
    return f"{kind.__name__}({', '.join(given)})"


class Members(dict[int, Any]):
    """The members of an enumeration by number; a look here is quicker than to call the enumeration."""

    def __init__(self, kind: Any) -> None:
        super().__init__()
        self._kind = kind

    def __missing__(self, number: int) -> Any:
        self[number] = self._kind(number)
        return self[number]


def base_of(hint: Any) -> Any:
    """Return the type of a field without its notes; of one that may be absent, the type of what is there."""
    if isinstance(hint, UnionType):
        return next(each for each in get_args(hint) if each is not NoneType)
    return get_args(hint)[0] if hasattr(hint, "__metadata__") else hint


def note_of(hint: Any, kind: Any) -> Any:
    """Return what is noted of a field, of one kind: a Quantity or an Array; None: nothing is."""
    return next((note for note in getattr(hint, "__metadata__", ()) if isinstance(note, kind)), None)


@cache
def members_of(kind: Any) -> list[tuple[str, Any, str]]:
    """Return name, type and words of each field, in C's order: what is smaller than a double comes last."""
    hints, words = get_type_hints(kind, include_extras=True), declared_words(kind)
    members = [(field.name, hints[field.name], words.get(field.name, "")) for field in fields(kind)]
    return sorted(members, key=lambda member: is_small(member[1]))


def is_small(hint: Any) -> bool:
    """Whether a field is an int32_t in C."""
    return isinstance(base_of(hint), type) and issubclass(base_of(hint), int)
