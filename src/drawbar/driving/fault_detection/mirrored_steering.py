"""Mirrored steering: the tractor turns the other way than its front wheels are measured.

Where sensor and motor are both the wrong way round, the steering follows its set points perfectly, but each turns the
tractor away from the line. So the direction of the tractor antenna's velocity, which the steering sensor does not
touch, is held against the one that the measured angle makes of it: the slope of its regression on that is about 1 with
a correct sensor, between 0 and 1 on soft ground, and about -1 with a mirrored one.
"""

import math
from collections import deque
from statistics import fmean

from drawbar.driving.fault_detection.running_rms import RunningRms
from drawbar.geometry import wrap
from drawbar.messages import Fixes
from drawbar.nanoseconds import seconds
from drawbar.vehicle.parameters import VehicleParameters

_SPAN, _WAY = 3.0, 3.0
"""of the regression, s, and m where that takes longer"""
_GAP = 0.5
"""longest between two epochs, s"""
_OLDEST = 0.3
"""of an epoch: the steering has moved on since, s"""
_LEAST_SPEED = 0.3
"""below which a velocity has no direction, m/s"""
_SPREAD = math.radians(2.0)
"""standard deviation of the predicted directions above which they are evidence, rad"""
_NOISE = 0.02
"""least standard deviation of a direction at 1 m/s, rad"""
_SURE, _SUSPECTED = 4.0, 2.2
"""standard deviations of the slope; and where the run is stopping as its position is not known well enough, or the
hitch angle contradicts, which a mirrored steering leads to at slow speed: sound wheels are twice as far from that"""
_LOW, _HIGH = 0.3, 1.6
"""magnitudes of the slope of which the sign counts"""
_LASTS, _REACHES = 0.4, 0.8
"""for which a disturbance lasts, and over which it reaches along the ground: s, m"""
_PRIOR, _PRIOR_TIME = 0.02, 5.0
"""prior root mean square of residuals and its weight: rad, s"""
_CLIP = 0.2
"""at which a residual is clipped, rad"""
_MINIMUM, _CONFIRMED = 4, 2
"""epochs of a regression, and regressions in a row that decide"""


class MirroredSteering:
    """Regression of the last seconds; what it has found stays until the opposite is."""

    def __init__(self, vehicle: VehicleParameters, sample_time: float) -> None:
        """Begin without an epoch."""
        self._wheelbase, self._ahead = vehicle.wheelbase, vehicle.masts.tractor.forward
        self._samples = deque[tuple[float, float, float]]()  # time, s; predicted and measured direction, rad
        self._turned = 0.0  # by the measured angles, rad
        self._rate = 0.0  # of that, rad/s
        self._in_a_row = 0
        self._rms = RunningRms(sample_time, prior=_PRIOR, prior_time=_PRIOR_TIME)  # of residuals, rad
        self.found = False
        """the steering is mirrored"""

    def receive_fixes(self, fixes: Fixes, steering: float, *, suspected: bool = False) -> None:
        """Update with an epoch and the measured angle of the front wheels, rad; begin anew without either, or late.

        suspected: the run is stopping as its position is not known well enough, or the hitch angle contradicts.
        """
        time, speed, course = seconds(fixes.epoch), fixes.tractor.speed, fixes.tractor.course
        known = speed >= _LEAST_SPEED and math.isfinite(course + steering)
        fresh = seconds(fixes.time) - time <= _OLDEST
        if not (known and fresh) or math.cos(course - fixes.tractor.yaw) < 0.0:  # backwards; not where no yaw is known
            self._samples.clear()
            return
        curvature = math.tan(steering) / self._wheelbase
        last, rate, self._rate = self._samples[-1] if self._samples else None, self._rate, speed * curvature
        if last is None or not 0.0 < time - last[0] <= _GAP:
            self._samples.clear()
            self._turned = 0.0
        else:
            self._turned += 0.5 * (rate + self._rate) * (time - last[0])
            course = last[2] + wrap(course - last[2])
        self._samples.append((time, self._turned + math.atan(self._ahead * curvature), course))
        while time - self._samples[0][0] > max(_SPAN, _WAY / speed):
            self._samples.popleft()
        self._judge(speed, _SUSPECTED if suspected else _SURE)

    def _judge(self, speed: float, sure: float) -> None:
        slope, deviation = self._slope(speed)
        sign = 0
        if max(sure * deviation, _LOW) < abs(slope) < _HIGH:
            sign = 1 if slope > 0.0 else -1
        self._in_a_row = self._in_a_row + sign if self._in_a_row * sign > 0 else sign
        if abs(self._in_a_row) >= _CONFIRMED:
            self.found = self._in_a_row < 0

    def _slope(self, speed: float) -> tuple[float, float]:
        """Return the slope of the regression and its standard deviation; infinite where too little was turned."""
        count = len(self._samples)
        if count < _MINIMUM:
            return 0.0, math.inf
        _, predicted, measured = zip(*self._samples, strict=True)
        x, y = ([each - fmean(values) for each in values] for values in (predicted, measured))
        square = sum(each * each for each in x)
        slope = sum(a * b for a, b in zip(x, y, strict=True)) / square if square > 0.0 else 0.0
        residual = math.sqrt(sum((b - slope * a) ** 2 for a, b in zip(x, y, strict=True)) / (count - 2))
        self._rms.add(min(residual, _CLIP))
        if square < count * _SPREAD**2:
            return 0.0, math.inf
        noise = max(residual, self._rms.value, _NOISE / speed)
        rate = (count - 1) / (self._samples[-1][0] - self._samples[0][0])
        together = max(rate * max(_LASTS, _REACHES / speed), 1.0)
        return slope, noise * math.sqrt(together / square)
