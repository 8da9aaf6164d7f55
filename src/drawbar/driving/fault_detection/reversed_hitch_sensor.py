"""Reversed hitch sensor: one whose angle is the negative of the one that the motion implies.

The estimate absorbs a reversed angle in yaws and crab angles at first. So the hitch angle is simulated from wheels and
joint alone (simulated_hitch_angle.py). Its error by unknown crab angles is too large for a limit on the residual. But
two hypotheses compete: measured = +simulated and measured = -simulated. Their mean squared residuals differ by four
times the mean of measured times simulated, which is rarely negative with a correct sensor.
"""

import math
from statistics import fmean

from drawbar.driving.fault_detection.recent import Recent
from drawbar.driving.fault_detection.running_rms import RunningRms
from drawbar.geometry import wrap

_SPAN = 0.6
"""over which the hypotheses are compared, s"""
_LIMIT, _FACTOR = math.radians(2.5), 2.2
"""root of a quarter of the difference of their mean squares, beyond which the sensor is reversed: rad, and root mean
squares of the residual of the better one"""
_SINGLE = 0.9
"""largest share of that limit by one sample, which may be false"""
_CLIP = math.radians(12.0)
"""at which a residual is clipped, rad"""


class ReversedHitchSensor:
    """Comparison of both hypotheses over the last samples."""

    def __init__(self, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._products = Recent[float](_SPAN, sample_time)  # measured times simulated, rad²
        self._rms = RunningRms(sample_time)  # residual, rad
        self.share = 0.0
        """the root of a quarter of the difference, of what is a reversed sensor"""

    def update(self, measured: float, simulated: float) -> bool:
        """Update with both angles, rad, NaN: unknown; return whether the sensor is reversed."""
        self.share = 0.0
        if not math.isfinite(simulated):
            self._products.clear()
            return False
        if math.isfinite(measured):
            self._products.append(measured * simulated)
            residuals = (abs(wrap(measured - sign * simulated)) for sign in (1.0, -1.0))
            self._rms.add(min(*residuals, _CLIP))
        if not self._products.is_full:
            return False
        limit = max(_LIMIT, _FACTOR * self._rms.value)
        least = -_SINGLE * len(self._products) * limit**2
        mean = fmean(max(each, least) for each in self._products)
        self.share = math.sqrt(max(-mean, 0.0)) / limit
        return self.share > 1.0
