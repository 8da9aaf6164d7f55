"""Columns of an experiment: which there are, so that a misspelt one is refused before anything is driven."""

from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

from drawbar.experiment.deviation import DEVIATION
from drawbar.misspelt import meant
from drawbar.report.path_errors import Bodies
from drawbar.signals import StepRecord

_ARRAY = ".0"
"""behind the name of an array, for any place in it"""


def unknown_columns(columns: Sequence[str], *, rehearsed: bool) -> list[str]:
    """Return those of some columns that no run has, each with the one that may be meant (see Task.columns)."""
    known = set(_of_rehearsals() if rehearsed else _of_runs())
    return [f"{name!r}{meant(name, known)}" for name in columns if not _is_there(name, known, rehearsed=rehearsed)]


def _is_there(name: str, known: set[str], *, rehearsed: bool) -> bool:
    head, _, place = name.rpartition(".")
    return (
        name in known
        or (place.isdecimal() and f"{head}{_ARRAY}" in known)
        or (not rehearsed and name.startswith(DEVIATION))  # of which an estimator's model may have none: NaN
    )


def _of_rehearsals() -> Iterator[str]:
    from drawbar.experiment.trial import WATCHED  # it brings the whole machine along

    yield from (f"watch.{name}" for name in WATCHED)


def _of_runs() -> Iterator[str]:
    yield from _numbers(StepRecord, "")
    yield from (f"{quantity}.{body.name}" for quantity in ("error", "progress") for body in fields(Bodies))


def _numbers(kind: Any, name: str) -> Iterator[str]:
    """Yield the names of all numbers of a signal of this type, each after the name of what it is in."""
    if get_origin(kind) is np.ndarray:
        yield f"{name}{_ARRAY}"
    elif is_dataclass(kind):
        for part, of_part in get_type_hints(kind).items():
            yield from _numbers(of_part, f"{name}.{part}" if name else part)
    elif parts := [part for part in get_args(kind) if is_dataclass(part)]:  # or None
        yield from _numbers(parts[0], name)
    else:
        yield name
