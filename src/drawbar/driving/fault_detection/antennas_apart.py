"""Antennas apart: both antennas are not where the chain of both bodies has them, one more to the left than the other.

An estimate that follows a drift of one antenna makes up for it by crab angles and yaws, but not for all of it: the
antenna that is right then stands aside of where it is estimated. Wheels and angles tell that within seconds, without
any velocity, whose direction lags in a curve. On rough ground, and where a mast leans that has no sensor, antennas
are apart by more.
"""

import math
from collections import deque
from statistics import fmean

from drawbar.driving.fault_detection.running_rms import RunningRms
from drawbar.geometry import arm_offset
from drawbar.signals import Pose, SolverStatus, StepRecord
from drawbar.vehicle.parameters import Mast, Masts

_SPAN = 1.6
"""over which it is averaged, s"""
_HELD = 2.0
"""for which the most counts: where a curve begins it shows less for a while, s"""
_LEAST, _USUAL = 0.06, 4.0
"""m, and times the usual: farther apart is a contradiction"""
_FIRST, _FIRST_TIME = 0.015, 5.0
"""what is usual before anything is known of ground and masts, and the time for which that counts: m, s"""
_LEARNED = 0.5
"""share of the limit that counts as usual at most"""
_MOVES = 0.1
"""speed below which nothing is learned, m/s"""


class AntennasApart:
    """How far apart the last samples have both antennas."""

    def __init__(self, masts: Masts, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._masts = masts
        self._lately = deque[float](maxlen=max(round(_SPAN / sample_time), 1))
        self._shares = deque[float](maxlen=max(round(_HELD / sample_time), 1))
        self._rms = RunningRms(sample_time, first=_FIRST, first_time=_FIRST_TIME)

    def update(self, record: StepRecord) -> float:
        """Take in a step.

        Returns:
            How far the tractor's was more to the left than the trailer's at most, now or a moment ago, as a share of
            what is a contradiction.
        """
        m, found = record.measurement, record.estimate
        tractor = _left(m.tractor_x, m.tractor_y, found.tractor, self._masts.tractor, m.tractor_roll, m.tractor_pitch)
        trailer = _left(m.trailer_x, m.trailer_y, found.trailer, self._masts.trailer, m.trailer_roll, m.trailer_pitch)
        if found.status is not SolverStatus.SOLVED or not math.isfinite(tractor + trailer):
            self._lately.clear()
            self._shares.clear()
            return 0.0
        self._lately.append(tractor - trailer)
        if len(self._lately) < (self._lately.maxlen or 0):
            return 0.0
        apart, limit = fmean(self._lately), max(_LEAST, _USUAL * self._rms.value)
        if abs(m.speed) >= _MOVES:
            self._rms.add(min(abs(apart), _LEARNED * limit))
        self._shares.append(apart / limit)
        return max(self._shares, key=abs)


def _left(x: float, y: float, body: Pose, mast: Mast, roll: float, pitch: float) -> float:
    """Return how far to the left of its estimated place an antenna is that is measured at (x, y), m."""
    lean, tilt = (
        angle if math.isfinite(angle) else 0.0 for angle in (roll - mast.roll_offset, pitch - mast.pitch_offset)
    )
    east, north = arm_offset(body.yaw, lean, tilt, mast.arm)
    return (y - body.y - north) * math.cos(body.yaw) - (x - body.x - east) * math.sin(body.yaw)
