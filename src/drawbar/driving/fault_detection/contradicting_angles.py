"""Contradicting angles: front wheels, joint and speed do not lead to the hitch angle that is measured.

A sensor that drifts is not seen by its residual: the estimate follows it, with yaws and crab angles that become more
and more wrong, and both bodies are steered beside the line. A simulation by wheels and joint alone
(simulated_hitch_angle.py) does not follow it.
"""

import math
from statistics import fmean

from drawbar.driving.fault_detection.recent import Recent
from drawbar.driving.fault_detection.running_rms import RunningRms
from drawbar.geometry import wrap

_SPAN = 1.0
"""over which the difference is averaged, s"""
_FACTOR, _LEAST = 5.5, math.radians(1.0)
"""root mean squares of the mean difference that are a contradiction, and the least that one counts, rad: without a
fault it comes to 0.95 of that (experiments/faults/ordinary.py)"""
_PRIOR, _PRIOR_TIME = math.radians(1.6), 5.0
"""prior root mean square and its weight: rad, s"""


class ContradictingAngles:
    """Mean difference of measured and simulated hitch angle, beside its root mean square on this ground."""

    def __init__(self, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._differences = Recent[float](_SPAN, sample_time)  # rad
        self._rms = RunningRms(sample_time, prior=_PRIOR, prior_time=_PRIOR_TIME)  # of their mean, rad
        self.share = 0.0
        """the mean, of what is a contradiction"""

    def update(self, measured: float, simulated: float) -> None:
        """Update with both hitch angles, rad, NaN: unknown."""
        self.share = 0.0
        if not math.isfinite(simulated):
            self._differences.clear()
            return
        if math.isfinite(measured):
            self._differences.append(wrap(measured - simulated))
        if not self._differences.is_full:
            return
        mean, rms = abs(fmean(self._differences)), self._rms.value
        self._rms.add_clipped(mean)
        self.share = mean / (_FACTOR * max(rms, _LEAST))
