"""Position drift: positions that go aside of what the receivers' own velocities say.

A receiver finds its velocity from the carrier's Doppler shift, which a wrongly fixed ambiguity or a drifting reference
does not touch. Over the last seconds the way between two positions is held against the velocity's integral, across it
only: a velocity in a wrong unit is seen elsewhere. Wheels that slip sideways do not matter, as both see that.

Until a drift is seen the estimate follows it, yaws and crab angles included. From then on the velocities' integral
takes the place of the positions, from where the antennas were before (driving/loop/controller.py).
"""

import math
from collections import deque
from dataclasses import dataclass, replace

from drawbar.geometry import wrap
from drawbar.messages import Fixes, seconds
from drawbar.signals import FixQuality, Measurement

_WINDOW = 2.0
"""over which both ways are compared, s"""
_JUMP = 0.5
"""m beside where the velocity leads from one epoch to the next: farther is no drift, and the estimator rejects it"""
_GAP = 0.5
"""between two epochs, after which it begins anew, s; as after a jump"""
_LEAST = 0.5
"""way that has a direction, m"""
_ASIDE, _SHARE = 0.2, 0.03
"""m, and of the way; farther aside is a contradiction"""
_LAG = 0.15
"""by which a receiver's filter lets the velocity's direction lag in a curve, s"""
_SAME = 1e-6
"""times nearer than this are the same, s"""
_CONTRADICTIONS = 2
"""epochs in a row that make a drift"""


@dataclass(frozen=True, slots=True)
class _Place:
    time: float
    x: float
    y: float
    velocity: tuple[float, float]
    way: tuple[float, float]
    """integral of the velocity, east and north, m"""


class _Antenna:
    """The last places of one antenna."""

    def __init__(self) -> None:
        self._places: deque[_Place] = deque()
        self._right: _Place | None = None

    def begin_dead_reckoning(self) -> None:
        """Hold to the oldest place."""
        self._right = self._places[0] if self._places else None

    def dead_reckoned(self) -> tuple[float, float]:
        """Return where the velocities have led from there, m; NaN where that is not known."""
        if self._right is None or not self._places:
            return math.nan, math.nan
        way, before = self._places[-1].way, self._right.way
        return self._right.x + way[0] - before[0], self._right.y + way[1] - before[1]

    def add(self, time: float, x: float, y: float, velocity: tuple[float, float]) -> bool:
        """Take in an epoch with a fixed solution, or NaN; return whether it contradicts."""
        known = math.isfinite(x + y + sum(velocity))
        if not known or (self._places and not self._goes_on(time, x, y)):
            self._places.clear()
            self._right = None
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
        while len(self._places) > 1 and time - self._places[1].time >= _WINDOW - _SAME:
            self._places.popleft()
        return time - self._places[0].time >= _WINDOW - _SAME and self._goes_aside()

    def _goes_on(self, time: float, x: float, y: float) -> bool:
        """Return whether a place can be the next one, without a gap or a jump."""
        last = self._places[-1]
        step = time - last.time
        led = (last.x + step * last.velocity[0], last.y + step * last.velocity[1])
        return 0.0 < step <= _GAP and math.dist((x, y), led) <= _JUMP

    def _goes_aside(self) -> bool:
        first, last = self._places[0], self._places[-1]
        east, north = last.way[0] - first.way[0], last.way[1] - first.way[1]
        way = math.hypot(east, north)
        if way < _LEAST:
            return False
        aside = (east * (last.y - first.y) - north * (last.x - first.x)) / way
        turned = abs(wrap(math.atan2(*reversed(last.velocity)) - math.atan2(*reversed(first.velocity))))
        lags = _LAG * turned / (last.time - first.time)
        return abs(aside) > max(_ASIDE, (_SHARE + lags) * way)


class PositionDrift:
    """What the last epochs say of both antennas; one that goes astray alone is the estimator's to reject."""

    def __init__(self) -> None:
        """Begin without an epoch."""
        self._tractor, self._trailer = _Antenna(), _Antenna()
        self._contradictions = 0

    @property
    def exists(self) -> bool:
        """Whether both antennas go aside."""
        return self._contradictions >= _CONTRADICTIONS

    def begin_dead_reckoning(self) -> None:
        """Hold to where both antennas were a moment before they were seen to drift."""
        self._tractor.begin_dead_reckoning()
        self._trailer.begin_dead_reckoning()

    def dead_reckoned(self, measurement: Measurement) -> Measurement:
        """Return a measurement with both antennas where the velocities have led from there; NaN after a lost epoch."""
        (x, y), (trailer_x, trailer_y) = self._tractor.dead_reckoned(), self._trailer.dead_reckoned()
        return replace(measurement, tractor_x=x, tractor_y=y, trailer_x=trailer_x, trailer_y=trailer_y)

    def hear(self, fixes: Fixes) -> None:
        """Take in an epoch."""
        time = seconds(fixes.epoch)
        tractor = self._tractor.add(time, *fixed_motion(fixes, "tractor"))
        trailer = self._trailer.add(time, *fixed_motion(fixes, "trailer"))
        self._contradictions = self._contradictions + 1 if tractor and trailer else 0


def fixed_motion(fixes: Fixes, body: str) -> tuple[float, float, tuple[float, float]]:
    """Return place (m) and velocity (m/s) of an antenna, NaN unless its ambiguities are fixed."""
    if getattr(fixes, f"{body}_quality") != FixQuality.FIXED:
        return math.nan, math.nan, (math.nan, math.nan)
    speed, course = getattr(fixes, f"{body}_speed"), getattr(fixes, f"{body}_course")
    velocity = (speed * math.cos(course), speed * math.sin(course))
    return getattr(fixes, f"{body}_x"), getattr(fixes, f"{body}_y"), velocity
