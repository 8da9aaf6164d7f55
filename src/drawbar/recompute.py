"""Recomputation of a recorded run: estimates, plans and commands from the measurements, compared with the record."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from drawbar.config import recorded_configuration
from drawbar.errors import DrawbarError, demand
from drawbar.estimation.settings import IdealEstimatorSettings
from drawbar.machine.base import EndOfMeasurements
from drawbar.machine.replayed import ReplayedMachine
from drawbar.recording.log import CUT_OFF, RunLog
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
    cut: str = ""
    """why it ends before the log, or the run, does; empty: it does not"""


def replay(log: RunLog, changes: Sequence[str] = ()) -> Replay:
    """Recompute a run from its recorded measurements.

    With the same build of drawbar on the same machine every number is the recorded one, bit for bit; predictions as far
    as they are recorded (step/record.py).

    Args:
        log: of the run.
        changes: settings to try instead of the recorded ones, KEY=VALUE.

    Raises:
        DrawbarError: the recorded configuration, or the changed one, cannot be built.
    """
    demand("log", log, RunLog, "give what read_log() returned")
    configuration = recorded_configuration(log.header.configuration, changes, "the log's configuration")
    autopilot = build_autopilot(configuration)
    autopilot.begin(log.header.path.path())
    logged = _unbroken(log)
    ideal = isinstance(configuration.estimator, IdealEstimatorSettings)
    records = []
    with ReplayedMachine(record.measurement for record in logged) as machine:
        for recorded in logged:
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
    comparison = Comparison(common_only=bool(changes))
    for recorded, recomputed in zip(logged, records, strict=True):
        comparison.add(recorded.step, recorded, recomputed)
    is_whole = len(logged) == len(log.records) and log.outcome is not CUT_OFF
    return comparison.replay(records, cut="" if is_whole else "; ".join(log.shortcomings))


def _unbroken(log: RunLog) -> tuple[StepRecord, ...]:
    """Return the steps before the first that is lost: behind it the autopilot's state is unknown.

    Raises DrawbarError: the first step is lost.
    """
    count = next((place for place, record in enumerate(log.records) if record.step != place), len(log.records))
    if log.records and not count:
        raise DrawbarError(f"the first steps are lost, and nothing can be recomputed ({'; '.join(log.losses)})")
    return log.records[:count]


class Comparison:
    """Collects where recomputed numbers are not the recorded ones."""

    def __init__(self, *, common_only: bool) -> None:
        """Begin with no difference; common_only: another setting may make more or fewer numbers, as a plan's stages."""
        self._common_only = common_only
        self._first: dict[str, Difference] = {}
        self._largest: dict[str, float] = {}

    def add(self, step: int, recorded: Any, recomputed: Any, prefix: str = "", names: Sequence[str] = ()) -> None:
        """Compare all numbers of two dataclasses of one kind, NaN being the same as NaN.

        A number that only one of them has is a difference, to NaN, or left out with `common_only`.

        Args:
            step: at which they were.
            recorded: what was recorded.
            recomputed: what was computed again.
            prefix: before the names of its numbers, with a dot behind it.
            names: of the fields to compare; empty: all that are computed.
        """
        before, now = dict(_numbers(recorded, names)), dict(_numbers(recomputed, names))
        for name in before | now:
            here, there = before.get(name, math.nan), now.get(name, math.nan)
            if name in before and name in now:
                same = here == there or (math.isnan(here) and math.isnan(there))
            else:
                same = self._common_only
            if not same:
                difference = Difference(step=step, signal=prefix + name, recorded=here, recomputed=there)
                self._first.setdefault(difference.signal, difference)
                self._largest[difference.signal] = np.fmax(self._largest.get(difference.signal, 0.0), difference.size)

    def replay(self, records: Sequence[StepRecord], *, cut: str = "") -> Replay:
        """Return the whole comparison, with the recomputed steps, and why they end before the log does."""
        differences = tuple(self._first.values())
        return Replay(records=tuple(records), differences=differences, largest=self._largest, cut=cut)


def _numbers(record: Any, names: Sequence[str]) -> Iterator[tuple[str, float]]:
    """Yield the dotted names and values of all numbers of a record that are computed, or of the fields named."""
    for field in fields(record):
        if field.name in names or not (names or field.name in _GIVEN):
            yield from _values(getattr(record, field.name), field.name)


def _values(value: Any, name: str) -> Iterator[tuple[str, float]]:
    if is_dataclass(value):
        for field in fields(value):
            yield from _values(getattr(value, field.name), f"{name}.{field.name}")
    elif isinstance(value, np.ndarray):
        yield from ((f"{name}.{index}", float(number)) for index, number in enumerate(value.ravel()))
    else:
        yield name, float(value)
