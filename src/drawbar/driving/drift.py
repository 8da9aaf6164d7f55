"""Drift: positions that go aside of what the receivers' own velocities say.

A receiver finds its velocity from the carrier's Doppler shift, which a wrongly fixed ambiguity or a drifting reference
does not touch. Over the last seconds the way between two positions is held against the velocity's integral, across it
only: a velocity in a wrong unit is seen elsewhere. Wheels that slip sideways do not matter, as both see that.
"""

import math
from collections import deque
from dataclasses import dataclass

from drawbar.messages import Fixes, seconds
from drawbar.signals import FixQuality

_WINDOW = 2.0
"""over which both ways are compared, s"""
_GAP = 0.5
"""between two epochs, after which it begins anew, s"""
_LEAST = 0.5
"""way that has a direction, m"""
_ASIDE, _SHARE = 0.3, 0.08
"""m, and of the way; farther aside is a contradiction. The share is what a receiver's filter lags in a curve"""
_CONTRADICTIONS = 3
"""epochs in a row that make a drift"""


@dataclass(frozen=True, slots=True)
class _Place:
    time: float
    x: float
    y: float
    velocity: tuple[float, float]
    way: tuple[float, float]
    """integral of the velocity, m"""


class _Antenna:
    """The last places of one antenna."""

    def __init__(self) -> None:
        self._places: deque[_Place] = deque()

    def add(self, time: float, x: float, y: float, velocity: tuple[float, float]) -> bool:
        """Take in an epoch with a fixed solution, or NaN; return whether it contradicts."""
        known = math.isfinite(x + y + sum(velocity))
        if not known or (self._places and not 0.0 < time - self._places[-1].time <= _GAP):
            self._places.clear()
        if not known:
            return False
        way = (0.0, 0.0)
        if self._places:
            last = self._places[-1]
            half = 0.5 * (time - last.time)
            way = (
                last.way[0] + half * (last.velocity[0] + velocity[0]),
                last.way[1] + half * (last.velocity[1] + velocity[1]),
            )
        self._places.append(_Place(time, x, y, velocity, way))
        while len(self._places) > 1 and time - self._places[1].time >= _WINDOW:
            self._places.popleft()
        return time - self._places[0].time >= _WINDOW and self._goes_aside()

    def _goes_aside(self) -> bool:
        first, last = self._places[0], self._places[-1]
        ahead, left = last.way[0] - first.way[0], last.way[1] - first.way[1]
        way = math.hypot(ahead, left)
        if way < _LEAST:
            return False
        aside = (ahead * (last.y - first.y) - left * (last.x - first.x)) / way
        return abs(aside) > max(_ASIDE, _SHARE * way)


class Drift:
    """What the last epochs say of both antennas; one that goes astray alone is the estimator's to reject."""

    def __init__(self) -> None:
        """Begin without an epoch."""
        self._tractor, self._trailer = _Antenna(), _Antenna()
        self._contradictions = 0

    @property
    def exists(self) -> bool:
        """Whether both antennas go aside."""
        return self._contradictions >= _CONTRADICTIONS

    def hear(self, fixes: Fixes) -> None:
        """Take in an epoch."""
        time = seconds(fixes.epoch)
        tractor = self._tractor.add(time, *_moved(fixes, "tractor"))
        trailer = self._trailer.add(time, *_moved(fixes, "trailer"))
        self._contradictions = self._contradictions + 1 if tractor and trailer else 0


def _moved(fixes: Fixes, body: str) -> tuple[float, float, tuple[float, float]]:
    """Return place (m) and velocity (m/s) of an antenna, NaN unless its ambiguities are fixed."""
    if getattr(fixes, f"{body}_quality") != FixQuality.FIXED:
        return math.nan, math.nan, (math.nan, math.nan)
    speed, course = getattr(fixes, f"{body}_speed"), getattr(fixes, f"{body}_course")
    velocity = (speed * math.cos(course), speed * math.sin(course))
    return getattr(fixes, f"{body}_x"), getattr(fixes, f"{body}_y"), velocity
