"""Turning error: how far the front wheels are measured beside the angle at which the tractor has turned.

The estimated yaw follows the antennas within a second or two, so it shows how the tractor has really turned. Slip and
creeping soil count as an error too: by 1° on firm ground, by up to 5° on a soft slope or where the grip is lost, in
curves by more. One that is larger is of the sensor, or of wheels with which nobody can steer.
"""

import math
from collections import deque

from drawbar.driving.fault_detection.running_rms import MOVES
from drawbar.geometry import wrap
from drawbar.signals import StepRecord

_SPAN, _WAY, _WHEELBASES = 1.0, 0.99, 0.7
"""over which it is averaged: s, and m, or a little less, and wheelbases, where that takes longer: by what the yaw is
corrected meanwhile counts in proportion to the wheelbase per way"""
_LIMIT, _SLIP = math.radians(6.0), 0.25
"""error that is too large, rad, and by how much more of a measured angle may be lost by slip: without a fault it comes
to 0.6 of that (experiments/faults/ordinary.py)"""


class TurningError:
    """The error over the last second and metre, or what is longer."""

    def __init__(self, wheelbase: float, sample_time: float) -> None:
        """Begin without a sample; `wheelbase` in m, `sample_time` in s."""
        self._wheelbase, self._sample_time = wheelbase, sample_time
        self._way = max(_WAY, _WHEELBASES * wheelbase)
        self._rates = 0.0, 0.0  # speed, m/s, and yaw rate by the wheels, rad/s, at the last sample
        self._samples = deque[tuple[float, float, float]]()
        """way, m; turned by the wheels, and yaw of the estimate, rad"""
        self.share = 0.0
        """the error, of one that is too large"""

    @property
    def is_large(self) -> bool:
        """Whether it is larger than by any ground."""
        return self.share > 1.0

    def update(self, record: StepRecord) -> float:
        """Update with a step; return the error, rad, positive where the tractor turns further to the left.

        NaN: speed or angle is not known, the tractor stands, or it has not moved far enough.
        """
        self.share, measured = 0.0, record.measurement
        speed = record.estimate.longitudinal_slip * measured.speed
        rates = speed, speed * math.tan(measured.tractor_steering) / self._wheelbase
        if not all(map(math.isfinite, rates)) or abs(measured.speed) < MOVES:
            self._samples.clear()
            return math.nan
        way, turned = (0.5 * self._sample_time * (a + b) for a, b in zip(rates, self._rates, strict=True))
        self._rates = rates
        if self._samples:
            way, turned = self._samples[-1][0] + way, self._samples[-1][1] + turned
        self._samples.append((way, turned, record.estimate.tractor.yaw))
        count = round(_SPAN / self._sample_time)
        while len(self._samples) > count + 1 and way - self._samples[1][0] >= self._way:
            self._samples.popleft()
        first, by_wheels, yaw = self._samples[0]
        if len(self._samples) <= count or way - first < self._way:
            return math.nan
        way, turned = way - first, turned - by_wheels
        error = (wrap(record.estimate.tractor.yaw - yaw) - turned) * self._wheelbase / way
        self.share = abs(error) / (_LIMIT + _SLIP * abs(turned * self._wheelbase / way))
        return error
