"""Symbols and numbers for sections of settings: equations are written once, their numbers are data."""

from collections.abc import Iterator
from typing import Any, TypeVar

import casadi as ca

from drawbar.settings import Settings

_Section = TypeVar("_Section", bound=Settings)


def numbers(settings: Settings) -> Iterator[float]:
    """Yield the numbers of a section and of the sections in it."""
    for _, value in settings:
        if isinstance(value, Settings):
            yield from numbers(value)
        elif isinstance(value, float):
            yield value


def symbolic(settings: _Section, symbols: Iterator[ca.SX]) -> _Section:
    """Return a section with the next symbols in place of its numbers, for equations that are written for numbers."""

    def replaced(value: Any) -> Any:
        if isinstance(value, Settings):
            return symbolic(value, symbols)
        return next(symbols) if isinstance(value, float) else value

    return type(settings).model_construct(**{name: replaced(value) for name, value in settings})
