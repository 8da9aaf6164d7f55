"""Named numbers: a number of a step by the dotted name of its field, and what there is where a name is none."""

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from drawbar.misspelt import meant
from drawbar.signals import StepRecord


def number_of(name: str) -> Callable[[StepRecord], Any]:
    """Return what reads one number of a step; of an array NaN where it is shorter."""
    head, _, place = name.rpartition(".")
    if not place.isdigit():
        return attrgetter(name)
    array, index = attrgetter(head), int(place)

    def number(record: StepRecord) -> Any:
        numbers = array(record)
        return numbers[index] if index < numbers.size else np.nan

    return number


def no_number(name: str, record: StepRecord) -> str:
    """Return the error that a name is that of no number of a step, with what is there instead."""
    value: Any = record
    parts = name.split(".")
    for place, part in enumerate(parts):
        known = _fields(value)
        if part not in known:
            of = ".".join(parts[:place]) or "a step"
            there = f"it has {', '.join(known)}" if known else "it is a number itself"
            return f"no column {name!r}: {of} has no {part!r}{meant(part, known)}; {there}"
        value = getattr(value, part)
    return f"no column {name!r}: it is no number; give one of its {', '.join(_fields(value)) or 'numbers'}"


def _fields(value: Any) -> list[str]:
    return [field.name for field in fields(value)] if is_dataclass(value) else []
