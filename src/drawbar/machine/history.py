"""What was true a little while ago: sensors report it late."""

from typing import NamedTuple

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.settings import Delay

_REACH = 3.0
"""How far back it goes, s: the longest latency and four times the largest jitter"""


class Moment(NamedTuple):
    """The true machine at one moment, as sensors see it."""

    age: float
    """s"""
    x: float
    """of the tractor's rear axle, m"""
    y: float
    yaw: float
    """rad"""
    trailer_yaw: float
    joint: float
    """phi - psi, rad"""
    steering: float
    speed: float
    """m/s"""
    tractor_roll: float
    tractor_pitch: float
    trailer_roll: float
    trailer_pitch: float
    tractor_yaw_rate: float
    """rad/s"""
    trailer_yaw_rate: float


class History:
    """The true states and attitudes of the last seconds, at every integration step."""

    def __init__(self, step: float, first: Floats, rng: np.random.Generator) -> None:
        """Begin with a machine that has always stood in its first state and attitude (15,)."""
        self._step, self._rng = step, rng
        self._rows = np.tile(first, (round(_REACH / step) + 2, 1))

    def append(self, rows: Floats) -> None:
        """Take in states and attitudes (m, 15) after the newest integration steps."""
        self._rows = np.concatenate((self._rows, rows))[len(rows) :]

    def seen(self, delay: Delay) -> Moment:
        """Return the moment that a sensor with this delay reports now; its jitter is drawn anew."""
        age = delay.latency + (delay.jitter * self._rng.standard_normal() if delay.jitter else 0.0)
        steps = min(max(round(age / self._step), 0), len(self._rows) - 2)
        row, before = self._rows[-1 - steps], self._rows[-2 - steps]
        turned = (row[2:4] - before[2:4]) / self._step
        return Moment(steps * self._step, *row[:7].tolist(), *row[-4:].tolist(), *turned.tolist())
