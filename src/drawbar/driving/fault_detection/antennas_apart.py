"""Antennas apart: the difference of both antennas' lateral residuals from the chain of both bodies.

An estimate that follows a drift of one antenna absorbs it in crab angles and yaws, but not all of it: the correct
antenna then has a lateral residual. Wheels and angles show that within seconds, without any velocity, whose direction
lags in a curve. The residual is larger on rough ground, and by masts that lean without an attitude sensor.
"""

import math
from statistics import fmean

from drawbar.driving.fault_detection.recent import Recent
from drawbar.driving.fault_detection.running_rms import MOVES, RunningRms
from drawbar.signals import Pose, SolverStatus, StepRecord
from drawbar.vehicle.parameters import Mast, Masts

_SPAN = 1.6
"""that the mean covers, s"""
_HELD = 2.0
"""for which the largest is held: it falls for a while where a curve begins, s"""
_LEAST, _FACTOR = 0.06, 4.0
"""m, and root mean squares: a larger difference is a contradiction"""
_PRIOR, _PRIOR_TIME = 0.015, 5.0
"""prior root mean square and its weight: m, s"""
_CLIP = 0.5
"""share of the limit at which a difference is clipped in the root mean square"""


class AntennasApart:
    """Difference of both lateral residuals over the last samples."""

    def __init__(self, masts: Masts, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._masts = masts
        self._recent = Recent[float](_SPAN, sample_time)
        self._shares = Recent[float](_HELD, sample_time)
        self._rms = RunningRms(sample_time, prior=_PRIOR, prior_time=_PRIOR_TIME)

    def update(self, record: StepRecord) -> float:
        """Update with a step.

        Returns:
            How far the tractor's was more to the left than the trailer's at most, now or a moment ago, as a share of
            what is a contradiction.
        """
        m, found = record.measurement, record.estimate
        tractor = _left(m.tractor_x, m.tractor_y, found.tractor, self._masts.tractor, m.tractor_roll, m.tractor_pitch)
        trailer = _left(m.trailer_x, m.trailer_y, found.trailer, self._masts.trailer, m.trailer_roll, m.trailer_pitch)
        if found.status is not SolverStatus.SOLVED or not math.isfinite(tractor + trailer):
            self._recent.clear()
            self._shares.clear()
            return 0.0
        self._recent.append(tractor - trailer)
        if not self._recent.is_full:
            return 0.0
        apart, limit = fmean(self._recent), max(_LEAST, _FACTOR * self._rms.value)
        if abs(m.speed) >= MOVES:
            self._rms.add(min(abs(apart), _CLIP * limit))
        self._shares.append(apart / limit)
        return max(self._shares, key=abs)


def _left(x: float, y: float, body: Pose, mast: Mast, roll: float, pitch: float) -> float:
    """Return how far to the left of its estimated place an antenna is that is measured at (x, y), m."""
    east, north = mast.measured_offset(body.yaw, roll, pitch)
    return (y - body.y - north) * math.cos(body.yaw) - (x - body.x - east) * math.sin(body.yaw)
