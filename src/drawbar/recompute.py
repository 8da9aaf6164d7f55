"""Recompute a recorded run: estimates, plans and commands from the measurements, compared with what was recorded."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from drawbar.config import recorded_configuration
from drawbar.estimation.settings import IdealEstimatorSettings
from drawbar.machine.base import EndOfMeasurements
from drawbar.machine.replayed import ReplayedMachine
from drawbar.recording.log import RunLog
from drawbar.recording.precision import as_recorded
from drawbar.signals import StepRecord
from drawbar.step.build import build_autopilot

_GIVEN = ("step", "measurement", "truth", "estimator_times", "tractor_times", "trailer_times")
"""what a replay takes over, or does not compute"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """Where a recomputed number is not the recorded one."""

    step: int
    signal: str
    """dotted name in StepRecord"""
    recorded: float
    recomputed: float

    @property
    def size(self) -> float:
        """By how much they differ; NaN where one of them is no number."""
        return abs(self.recomputed - self.recorded)


@dataclass(frozen=True, slots=True, kw_only=True)
class Replay:
    """A run computed again."""

    records: tuple[StepRecord, ...]
    """recomputed"""
    differences: tuple[Difference, ...]
    """the first one of each signal, in the order of their steps"""
    largest: dict[str, float]
    """largest difference of each signal that differs"""


def replay(log: RunLog, changes: Sequence[str] = ()) -> Replay:
    """Recompute a run from its recorded measurements.

    With the same build of drawbar on the same machine every number is the recorded one, bit for bit; predictions as far
    as they are recorded (recording/precision.py).

    Args:
        log: of the run.
        changes: settings to try instead of the recorded ones, KEY=VALUE.

    Raises:
        DrawbarError: the recorded configuration, or the changed one, cannot be built.
    """
    configuration = recorded_configuration(log.header.configuration, changes, "the log's configuration")
    autopilot = build_autopilot(configuration)
    autopilot.begin(log.header.path.path())
    ideal = isinstance(configuration.estimator, IdealEstimatorSettings)
    records = []
    with ReplayedMachine(record.measurement for record in log.records) as machine:
        for recorded in log.records:
            try:
                measurement = machine.read()
            except EndOfMeasurements:
                break
            if ideal:
                autopilot.give(recorded.estimate)
            _, command = autopilot.feedback(measurement)
            machine.write(command)
            autopilot.prepare()
            records.append(autopilot.record(recorded.truth))
    first: dict[str, Difference] = {}
    largest: dict[str, float] = {}
    for recorded, recomputed in zip(log.records, records, strict=True):
        for difference in _differences(recorded, as_recorded(recomputed)):
            first.setdefault(difference.signal, difference)
            largest[difference.signal] = np.fmax(largest.get(difference.signal, 0.0), difference.size)
    return Replay(records=tuple(records), differences=tuple(first.values()), largest=largest)


def _differences(recorded: StepRecord, recomputed: StepRecord) -> Iterator[Difference]:
    """Yield every number that is not the same in both, NaN being the same as NaN."""
    for (name, here), (_, there) in zip(_numbers(recorded), _numbers(recomputed), strict=True):
        if not (here == there or (math.isnan(here) and math.isnan(there))):
            yield Difference(step=recorded.step, signal=name, recorded=here, recomputed=there)


def _numbers(value: Any, name: str = "") -> Iterator[tuple[str, float]]:
    """Yield the dotted names and values of all numbers of a record that are computed."""
    if is_dataclass(value):
        for field in fields(value):
            if name or field.name not in _GIVEN:
                yield from _numbers(getattr(value, field.name), f"{name}.{field.name}" if name else field.name)
    elif isinstance(value, np.ndarray):
        yield from ((f"{name}.{index}", float(number)) for index, number in enumerate(value.ravel()))
    else:
        yield name, float(value)
