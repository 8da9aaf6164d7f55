"""Initialisation of a component in C: its settings after construction, laid down once."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from textwrap import fill
from typing import Any

from numpy.typing import NDArray

from drawbar.codegen import Component

_C_TYPES = {"f": "double", "i": "int32_t"}


def initialiser(component: Component) -> str:
    """Return the C function that makes a component ready to begin: all zero, its settings, and what follows from them.

    Rows that repeat, as weights do from stage to stage, are stored once.
    """
    tables = {kind: list(_runs(component, kind)) for kind in _C_TYPES}
    used = [c_type for kind, c_type in _C_TYPES.items() if tables[kind]]
    calls = "".join(f"    WRITE_SETTINGS(component, {c_type}_settings, {c_type}_values);\n" for c_type in used)
    laid_down = component.unit.constants
    constants = f"    {laid_down};\n" if laid_down else ""
    return f"""
{"".join(_table(c_type, tables[kind]) for kind, c_type in _C_TYPES.items() if tables[kind])}
int UNIT(initialise)(struct component *component)
{{
    memset(component, 0, sizeof *component);
{calls}{constants}    return 0;
}}
"""


@dataclass(frozen=True, slots=True)
class _Run:
    """Equal consecutive rows of one setting."""

    member: str
    first: int
    """index of the first row"""
    row: tuple[float | int, ...]
    count: int


def _runs(component: Component, kind: str) -> Iterator[_Run]:
    """Yield what is not zero in the settings of one kind of number."""
    for member, array in component.settings.settings().items():
        if array.dtype.kind != kind:
            continue
        first = 0
        for row, count in _grouped(array):
            if any(row):
                yield _Run(member, first, row, count)
            first += count


def _grouped(array: NDArray[Any]) -> list[tuple[tuple[float | int, ...], int]]:
    """Return the rows of an array, and how often each repeats; a vector that repeats little is one row."""
    rows = [(row, len(list(group))) for row, group in groupby(map(tuple, array.reshape(len(array), -1).tolist()))]
    if array.ndim == 1 and 4 * len(rows) > len(array):
        return [(tuple(array.tolist()), 1)]
    return rows


def _table(c_type: str, runs: list[_Run]) -> str:
    """Return the values and where they belong, as C."""
    values, places, count = [], [], 0
    for run in runs:
        width = len(run.row)
        values.append(
            fill(f"{', '.join(map(literal, run.row))},", 118, initial_indent="    ", subsequent_indent="    ")
        )
        offset = f"offsetof(struct component, {run.member})"
        if run.first:
            offset += f" + {run.first * width} * sizeof({c_type})"
        places.append(f"    {{{offset}, {count}, {width}, {run.count}}},")
        count += width
    return (
        f"static const {c_type} {c_type}_values[] = {{\n{_lines(values)}\n}};\n"
        f"static const struct setting {c_type}_settings[] = {{\n{_lines(places)}\n}};\n"
    )


def _lines(lines: list[str]) -> str:
    return "\n".join(lines)


def literal(value: float | int) -> str:
    """Return a number as C that reads back as the very same."""
    if isinstance(value, int):
        return str(value)
    if math.isinf(value):
        return "(double)INFINITY" if value > 0.0 else "-(double)INFINITY"
    return "(double)NAN" if math.isnan(value) else repr(value)
