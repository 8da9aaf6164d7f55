"""Antenna drift: how far the positions of one antenna depart from its velocities.

Over the last seconds for a fast drift, over a longer time for a slow one.
"""

import math
from collections import deque

from drawbar.driving.fault_detection.displacement_error import (
    GAP,
    SAME,
    CourseLag,
    DisplacementError,
    PositionSample,
    PositionWindow,
    VelocityIntegral,
    mean_of,
)

_WINDOW = 2.0
"""over which both displacements are compared, s"""
_LONG_WINDOW = 8.0
"""over which a slow drift is looked for, s"""
_MEAN_TIME = 1.0
"""that its mean covers, s"""
_LIMIT, _LIMIT_SHARE = 0.15, 0.03
"""m, and of the distance: limit of the cross-track error; a larger mean of both antennas is a contradiction"""
_SLOW_LIMIT, _SLOW_LIMIT_SHARE = 0.20, 0.01
"""m, and of the distance: the same over the longer time, in which noise counts less"""
_SPEED_ERROR = 0.15
"""of the distance, by which positions may be ahead of the velocities, or behind; more means speeds in a wrong unit"""
_LAG, _LONG_LAG = 0.15, 0.3
"""by which a receiver's filter lets the velocity's direction lag in a curve at most, s; over the longer time, in which
a lag counts more than noise"""
_MISSING = 3.0
"""longest without a fixed solution, after which it begins anew, s"""


class AntennaDrift:
    """The last positions of one antenna, and where its velocities lead."""

    def __init__(self) -> None:
        """Begin without an epoch."""
        self._window, self._long_window = PositionWindow(_WINDOW), PositionWindow(_LONG_WINDOW)
        self._integral = VelocityIntegral()
        self._lag, self._long_lag = CourseLag(_WINDOW, _LAG), CourseLag(_LONG_WINDOW, _LONG_LAG)
        self._recent = deque[tuple[float, DisplacementError]]()
        """times, s, and displacement errors over the longer time"""
        self._anchor: PositionSample | None = None
        """from which dead reckoning goes on"""
        self._before: PositionSample | None = None
        """the last sample before a jump that came with the newest epoch"""
        self._jumped = math.nan
        self.is_known = False
        """the newest epoch has its position"""
        self.ratio = math.nan
        """cross-track error over the limit at which that of both antennas is a contradiction, NaN: not known"""

    @property
    def jumped(self) -> float:
        """Time of the last jump that has stayed, NaN: none, s."""
        return self._jumped if self._before is None else math.nan

    @property
    def long_lag(self) -> float:
        """Largest lag of the velocity's direction over the longer time, s."""
        return self._long_lag.largest

    @property
    def slow_error(self) -> DisplacementError | None:
        """Displacement error over the longer time, mean of the last epochs; None where unknown."""
        if not self._recent or self._recent[-1][0] - self._recent[0][0] < _MEAN_TIME - SAME:
            return None
        return mean_of([error for _, error in self._recent])

    @property
    def slow_ratio(self) -> float:
        """The same over its limit, as `add` returns it."""
        return math.nan if (error := self.slow_error) is None else slow_ratio(error, self.long_lag)

    def begin_dead_reckoning(self, *, slowly: bool) -> None:
        """Go on from the oldest position, of the longer time where the drift is slow."""
        self._anchor = self._long_window.oldest if slowly else self._window.oldest

    def dead_reckoned(self) -> tuple[float, float]:
        """Return the position by the velocity's integral from there, m; NaN where that is not known."""
        if self._anchor is None:
            return math.nan, math.nan
        now, before = self._integral.value, self._anchor.integral
        return self._anchor.x + now[0] - before[0], self._anchor.y + now[1] - before[1]

    def add(self, time: float, x: float, y: float, velocity: tuple[float, float]) -> float:
        """Add an epoch; its position is NaN where it has no fixed solution. Return the ratio."""
        self.ratio = self._add(time, x, y, velocity)
        return self.ratio

    def _add(self, time: float, x: float, y: float, velocity: tuple[float, float]) -> float:
        continues = self._integral.add(time, velocity)
        last, was_known = self._window.newest, self.is_known
        self.is_known = math.isfinite(x + y + sum(velocity))
        if not continues or (last is not None and time - last.time > _MISSING):
            self._begin_anew()
            last = None
        if not self.is_known:
            self._before = None
            self._recent.clear()
            return math.nan
        if last is not None and was_known and time - last.time <= GAP:
            self._follow(last, time, x, y)
        elif last is not None and not last.is_near(x, y, self._integral.value):
            self._begin_anew()
        sample = PositionSample(time, x, y, velocity, self._integral.value, self._integral.uncertainty)
        self._window.add(sample)
        self._long_window.add(sample)
        error = self._window.error(self._window.integral)
        if error is None:
            self._recent.clear()
            return math.nan
        self._add_slow_error(time, fits=abs(error.along_track) <= max(_SLOW_LIMIT, _SPEED_ERROR * error.distance))
        return self._ratio(time, error)

    def _begin_anew(self) -> None:
        self._window.clear()
        self._long_window.clear()
        self._recent.clear()
        self._anchor = None

    def _follow(self, last: PositionSample, time: float, x: float, y: float) -> None:
        """Follow to the next epoch: a position to which the last one does not lead has jumped.

        A position that goes back after a single epoch has not.
        """
        if last.leads_to(time, x, y):
            self._before = None
            return
        self._begin_anew()
        goes_back = self._before is not None and self._before.leads_to(time, x, y)
        self._before, self._jumped = (None, math.nan) if goes_back else (last, time)

    def _ratio(self, time: float, error: DisplacementError) -> float:
        ratio = error.ratio(_LIMIT, _LIMIT_SHARE, self._lag.largest)
        for lag in (self._lag, self._long_lag):
            lag.add(time, error.cross_track, error.lag_sensitivity)
        return ratio

    def _add_slow_error(self, time: float, *, fits: bool) -> None:
        """Add the error over the longer time, if the speeds fit the positions over the shorter one."""
        error = self._long_window.error(self._window.integral)
        if error is None or not fits:
            self._recent.clear()
            return
        self._recent.append((time, error))
        while time - self._recent[0][0] > _MEAN_TIME + SAME:
            self._recent.popleft()


def slow_ratio(error: DisplacementError, lag: float) -> float:
    """Return the cross-track error over the longer time over its limit."""
    return error.ratio(_SLOW_LIMIT, _SLOW_LIMIT_SHARE, lag)
