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


def series(steps: Sequence[ShownStep], name: str) -> list[list[float | None]]:
    """Return pairs of time (s, 0 is now) and value of a signal; None: it is missing."""
    if not steps:
        return []
    now = steps[-1].record.measurement.time
    return [[round(each.record.measurement.time - now, 3), _value(each, name)] for each in steps]


def band(steps: Sequence[ShownStep], name: str) -> list[list[list[float | None]]]:
    """Return series of an estimated signal less and plus its standard deviation; none where that is not known."""
    section, _, field = name.rpartition(".")
    if section != "estimate" or not any(field in step.deviations for step in steps):
        return []
    deviations = [step.deviations.get(field, math.nan) for step in steps]
    return [
        [
            [time, _rounded(value + sign * deviation) if value is not None else None]
            for (time, value), deviation in zip(series(steps, name), deviations, strict=True)
        ]
        for sign in (-1.0, 1.0)
    ]


def _value(step: ShownStep, name: str) -> float | None:
    first, _, rest = name.partition(".")
    try:
        found = getattr(step.controller, rest) if first == "controller" else _picker(name)(step.record)
        number = float(found)
    except (AttributeError, TypeError, ValueError, IndexError):
        return None
    return _rounded(number)


def _rounded(number: float) -> float | None:
    return float(f"{number:.6g}") if math.isfinite(number) else None


@cache
def _picker(name: str) -> Any:
    """Return what picks a number of a step; a last part of digits is an index."""
    section, _, last = name.rpartition(".")
    if not last.isdigit():
        return attrgetter(name)
    array, index = attrgetter(section), int(last)
    return lambda record: array(record).flat[index]
