"""Antenna distance: of both antennas from each other, against that which the chain of both bodies gives.

Receivers that are corrected from different base stations are decimetres apart, by a shift that does not turn with the
vehicle. An estimate absorbs it in yaws and crab angles, and leads both bodies beside the line. The distance shows what
of the shift is along the vehicle; a wrong hitch angle or crab angle hardly changes it. As the shift stays where the
vehicle has turned, a distance that was wrong counts until it is right again in that direction, or against it. Positions
without an RTK fix differ by as much with one base: they are not compared.
"""

import math
from statistics import fmean

from drawbar.driving.fault_detection.recent import Recent
from drawbar.signals import FixQuality, FixStatus, Pose, SolverStatus, StepRecord
from drawbar.vehicle.articulated import trailer_antenna
from drawbar.vehicle.lengths import length_values
from drawbar.vehicle.parameters import Mast, VehicleParameters

_SPAN = 2.0
"""that the mean covers, s"""
_SAME_WAY = math.cos(math.radians(30.0))
"""cosine between two directions, forwards or backwards, up to which they are the same"""
_LIMIT, _LEAN = 0.15, 0.05
"""of the mean difference, m, and of the height of a mast whose pitch is not measured, in addition"""


class AntennaDistance:
    """Mean difference of the distances over the last samples."""

    def __init__(self, vehicle: VehicleParameters, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._lengths = length_values(vehicle)
        self._masts = vehicle.masts
        self._differences = Recent[tuple[float, float]](_SPAN, sample_time)
        """m, and in which direction the tractor's antenna was, rad"""
        self._wrong: float | None = None
        """direction in which it was wrong, rad"""

    def update(self, record: StepRecord) -> bool:
        """Update with a step; return whether the distance is wrong, or was. One without both fixes begins anew."""
        m, found = record.measurement, record.estimate
        angles = (0.0, -found.hitch_angle - found.trailer_steering, found.trailer_steering)
        expected = math.hypot(*(float(each) for each in trailer_antenna(self._lengths, 0.0, 0.0, *angles)))
        x, y = _ground(m.tractor_x, m.tractor_y, found.tractor, self._masts.tractor, m.tractor_roll, m.tractor_pitch)
        u, v = _ground(m.trailer_x, m.trailer_y, found.trailer, self._masts.trailer, m.trailer_roll, m.trailer_pitch)
        difference = math.hypot(u - x, v - y) - expected
        believed = found.tractor_fix is found.trailer_fix is FixStatus.ACCEPTED
        fixed = m.tractor_fix_quality is m.trailer_fix_quality is FixQuality.FIXED
        if not (believed and fixed and found.status is SolverStatus.SOLVED and math.isfinite(difference)):
            self._differences.clear()
            return self._wrong is not None
        self._differences.append((difference, math.atan2(y - v, x - u)))
        pitches = ((self._masts.tractor.up, m.tractor_pitch), (self._masts.trailer.up, m.trailer_pitch))
        limit = _LIMIT + _LEAN * sum(up for up, pitch in pitches if math.isnan(pitch))
        if self._differences.is_full:
            self._judge(limit)
        return self._wrong is not None

    def _judge(self, limit: float) -> None:
        differences, directions = zip(*self._differences, strict=True)
        is_wrong, wrong = abs(fmean(differences)) > limit, self._wrong
        if wrong is None:
            self._wrong = directions[len(directions) // 2] if is_wrong else None
        elif not is_wrong and all(abs(math.cos(each - wrong)) >= _SAME_WAY for each in directions):
            self._wrong = None


def _ground(x: float, y: float, body: Pose, mast: Mast, roll: float, pitch: float) -> tuple[float, float]:
    """Return where the point below an antenna is that is measured at (x, y), m."""
    east, north = mast.measured_offset(body.yaw, roll, pitch)
    return x - east, y - north
