"""History: the truth of a little while ago, since sensors report it late."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.sensor_settings import Delay

_REACH = 3.0
"""How far back it goes, s: the longest latency and four times the largest jitter"""
_SPARE = 4
"""room for so many times that"""
YAWS = slice(2, 4)
"""columns of a row that hold both bodies' yaws, rad; the others are the machine's own affair"""


class BodyMoment(NamedTuple):
    """One body at one moment."""

    x: float
    """of its point on the ground, m"""
    y: float
    yaw: float
    """rad"""
    roll: float
    pitch: float
    yaw_rate: float
    """rad/s"""


class Moment(NamedTuple):
    """The true machine at one moment, as sensors see it."""

    age: float
    """s"""
    tractor: BodyMoment
    trailer: BodyMoment
    hitch_angle: float
    """beta, rad"""
    joint: float
    """phi - psi, rad"""
    steering: float
    speed: float
    """of the wheels, m/s"""


Read = Callable[[float, list[float], tuple[float, float]], Moment]
"""makes a moment of its age, a machine's row of n numbers, and the yaw rates of both bodies then"""


class History:
    """The true machine of the last seconds, a row of numbers at every integration step."""

    def __init__(self, step: float, first: Floats, rng: np.random.Generator, read: Read) -> None:
        """Begin with a machine that has always stood as in its first row (n,)."""
        self._step, self._rng, self._read = step, rng, read
        self._reach = round(_REACH / step) + 2
        self._rows = np.tile(first, (_SPARE * self._reach, 1))
        self._end = self._reach  # of the known rows; where there is no room behind it the newest move to the front
        self._moments: dict[int, Moment] = {}  # since the newest row, by steps ago

    def append(self, rows: Floats) -> None:
        """Take in the rows (m, n) after the newest integration steps."""
        rows = rows[-self._reach :]
        if self._end + len(rows) > len(self._rows):
            self._rows[: self._reach] = self._rows[self._end - self._reach : self._end]
            self._end = self._reach
        self._rows[self._end : self._end + len(rows)] = rows
        self._end += len(rows)
        self._moments.clear()

    def seen(self, delay: Delay) -> Moment:
        """Return the moment that a sensor with this delay reports now; its jitter is drawn again."""
        latency, jitter = delay.latency, delay.jitter
        age = latency + jitter * self._rng.standard_normal() if jitter else latency
        steps = min(max(round(age / self._step), 0), self._reach - 2)
        if (moment := self._moments.get(steps)) is None:
            newest = self._end - 1 - steps
            before, row = self._rows[newest - 1 : newest + 1].tolist()
            rates = [(now - then) / self._step for now, then in zip(row[YAWS], before[YAWS], strict=True)]
            moment = self._moments[steps] = self._read(steps * self._step, row, (rates[0], rates[1]))
        return moment
