"""Signals of the newest control steps by name, as far as they are looked at."""

import math
from collections.abc import Mapping, Sequence
from functools import cache
from operator import attrgetter
from typing import Any, NamedTuple

from drawbar.messages import ControllerState
from drawbar.recording.table import number_names
from drawbar.signals import StepRecord


class ShownStep(NamedTuple):
    """A control step, and what else was known then."""

    record: StepRecord
    controller: ControllerState | None
    deviations: Mapping[str, float] = {}
    """standard deviations by the names of the estimate's fields"""


PRESETS: Mapping[str, tuple[str, ...]] = {
    "plot_errors": ("reference.tractor.lateral_error", "reference.trailer.lateral_error"),
    "plot_times": (
        "estimator_times.feedback",
        "tractor_times.feedback",
        "trailer_times.feedback",
        "estimator_times.prepare",
        "tractor_times.prepare",
        "trailer_times.prepare",
    ),
    "plot_tubes": ("tractor_steering.margin", "trailer_steering.margin"),
    "plot_slips": (
        "estimate.longitudinal_slip",
        "estimate.tractor_slip",
        "estimate.trailer_slip",
    ),
    "plot_angles": (
        "estimate.steering_offset",
        "estimate.tractor_crab",
        "estimate.trailer_crab",
    ),
    "plot_certainty": ("controller.lateral_deviation", "controller.heading_deviation"),
    "plot_steering": (
        "command.tractor_steering",
        "measurement.tractor_steering",
        "command.trailer_steering",
        "measurement.trailer_steering",
    ),
}
"""by catalogue's key"""
_OF_CONTROLLER = ("lateral_deviation", "heading_deviation", "correction_age", "solved", "overruns")


def all_names(steps: Sequence[ShownStep]) -> list[str]:
    """Return the names of all signals that there are."""
    names = [name for step in list(steps)[-1:] for name in number_names(step.record)]
    return [*names, *(f"controller.{name}" for name in _OF_CONTROLLER)] if names else []


class Column(NamedTuple):
    """What is drawn of each step: a signal, plus so many of its standard deviations."""

    name: str
    deviations: float = 0.0


def columns(steps: Sequence[ShownStep], names: Sequence[str]) -> list[Column]:
    """Return the columns of signals: where the deviation of an estimated one is known, three."""
    found = []
    for name in names:
        section, _, field = name.rpartition(".")
        known = section == "estimate" and any(field in step.deviations for step in steps)
        found += [Column(name), *([Column(name, -1.0), Column(name, 1.0)] if known else [])]
    return found


def row(step: ShownStep, columns: Sequence[Column]) -> list[float | None]:
    """Return time (s) and values of a step; None: it is missing."""
    return [round(step.record.measurement.time, 3), *(_value(step, column) for column in columns)]


def _value(step: ShownStep, column: Column) -> float | None:
    first, _, rest = column.name.partition(".")
    try:
        found = getattr(step.controller, rest) if first == "controller" else _picker(column.name)(step.record)
        number = float(found)
    except (AttributeError, TypeError, ValueError, IndexError):
        return None
    if column.deviations:
        number += column.deviations * step.deviations.get(column.name.rpartition(".")[2], math.nan)
    return float(f"{number:.6g}") if math.isfinite(number) else None


@cache
def _picker(name: str) -> Any:
    """Return what picks a number of a step; a last part of digits is an index."""
    section, _, last = name.rpartition(".")
    if not last.isdigit():
        return attrgetter(name)
    array, index = attrgetter(section), int(last)
    return lambda record: array(record).flat[index]
