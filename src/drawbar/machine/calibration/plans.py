"""Plans of a calibration: the pushes that find the dead band, and those that find full rate, lag and dead time."""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass

from drawbar.machine.calibration.valve import MOVED, RUNS, PushRecord

_MOVING = 4
"""pushes that have moved, at which a run ends"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Push:
    """A drive from rest."""

    drive: float
    """-1 to 1"""
    duration: float
    """s"""
    pause: float
    """without a drive behind it, in which the motion dies out, s"""
    enough: float = math.inf
    """motion at which the push ends before its time, rad"""


class Plan(ABC):
    """Which pushes a calibration makes."""

    @abstractmethod
    def next_push(self, last: PushRecord | None) -> Push | None:
        """Return the next push, or None when there is nothing more to do.

        Args:
            last: what the last one did; None before the first.

        Raises:
            NoMotion: it has pushed as far as it may, and nothing moved.
        """


class NoMotion(Exception):  # noqa: N818 -- what was seen, not a mistake
    """The largest drive that is allowed moved nothing."""


class DeadBandPlan(Plan):
    """Raise the drive by 1 % from push to push until four have moved, to one side and then back, three times."""

    def __init__(self, *, largest: float = 0.4, runs: int = RUNS) -> None:
        """Take the numbers.

        Args:
            largest: drive; when nothing has moved at it, there is no feedback.
            runs: to each side.
        """
        self.runs: dict[int, list[list[PushRecord]]] = {1: [], -1: []}
        """pushes of each run, by the drive's sign"""
        self.done = 0
        """runs so far"""
        self._largest, self._count = largest, runs
        self._pushes = self._sequence()
        self._last: PushRecord | None = None

    def next_push(self, last: PushRecord | None) -> Push | None:
        """Return the next push."""
        self._last = last
        return next(self._pushes, None)

    def _sequence(self) -> Iterator[Push]:
        for i in range(2 * self._count):
            sign = 1 if i % 2 == 0 else -1
            run: list[PushRecord] = []
            self.runs[sign].append(run)
            for percent in range(1, round(100.0 * self._largest) + 1):
                yield Push(drive=sign * percent / 100.0, duration=0.5, pause=0.5)
                assert self._last is not None
                run.append(self._last)
                if sum(abs(push.moved) > MOVED for push in run) == _MOVING:
                    break
            else:
                raise NoMotion(
                    f"no feedback: up to a drive of {self._largest:.0%} no {_MOVING} pushes moved it by "
                    f"{math.degrees(MOVED):.1f}°; check the valve's power and the sensor's lever"
                )
            self.done = i + 1


class RatePlan(Plan):
    """Large pushes, alternately to both sides, for full rate, lag and dead time."""

    def __init__(self, *, drives: tuple[float, float] = (0.45, 0.45), pushes: int = 5) -> None:
        """Take the numbers.

        Args:
            drives: of every positive and every negative push, as large as the limits of rate allow.
            pushes: to each side.
        """
        self.records: dict[int, list[PushRecord]] = {1: [], -1: []}
        """by the drive's sign"""
        self._drives, self._count = drives, pushes
        self.done = 0
        """pushes so far"""
        self._made = 0

    def next_push(self, last: PushRecord | None) -> Push | None:
        """Return the next push."""
        if last is not None:
            self.records[1 if last.drive > 0.0 else -1].append(last)
            self.done += 1
        if self._made == 2 * self._count:
            return None
        drive = self._drives[0] if self._made % 2 == 0 else -self._drives[1]
        self._made += 1
        return Push(drive=drive, duration=1.5, pause=0.8, enough=math.radians(4.0))
