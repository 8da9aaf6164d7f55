"""Contradicting angles: front wheels, joint and speed do not lead to the hitch angle that is measured.

A sensor that drifts is not seen by its residual: the estimate follows it, with yaws and crab angles that become more
and more wrong, and both bodies are steered beside the line. A simulation by wheels and joint alone
(simulated_hitch_angle.py) does not follow it. Where the tractor does not turn as its front wheels are measured either
(turning_error.py), theirs is the wrong sensor; whether else hitch or joint is, is not observable.
"""

import math
from enum import Enum
from statistics import fmean

from drawbar.driving.fault_detection.recent import Recent
from drawbar.driving.fault_detection.running_rms import RunningRms
from drawbar.geometry import wrap

_SPAN = 1.0
"""over which the difference is averaged, s"""
_FACTOR, _LEAST = 5.5, math.radians(1.0)
"""root mean squares of the mean difference that are a contradiction, and the least that one counts, rad: without a
fault it comes to 0.9 of that (experiments/faults/ordinary.py)"""
_PRIOR, _PRIOR_TIME = math.radians(1.6), 5.0
"""prior root mean square and its weight: rad, s"""
_TURNING = math.radians(3.3)
"""turning error beyond which the front wheels' sensor is the wrong one, rad"""


class Contradiction(Enum):
    """Which sensor contradicts."""

    NONE = 0
    TRAILER = 1
    """of hitch or joint"""
    FRONT_WHEELS = 2


class ContradictingAngles:
    """Mean difference of measured and simulated hitch angle, beside its root mean square on this ground."""

    def __init__(self, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._differences = Recent[float](_SPAN, sample_time)  # rad
        self._rms = RunningRms(sample_time, prior=_PRIOR, prior_time=_PRIOR_TIME)  # of their mean, rad
        self.share = 0.0
        """the mean, of what is a contradiction"""

    def update(self, measured: float, simulated: float, turning_error: float) -> Contradiction:
        """Update with both hitch angles and the turning error, rad, NaN: unknown; return what contradicts."""
        self.share = 0.0
        if not math.isfinite(simulated):
            self._differences.clear()
            return Contradiction.NONE
        if math.isfinite(measured):
            self._differences.append(wrap(measured - simulated))
        if not self._differences.is_full:
            return Contradiction.NONE
        mean, rms = abs(fmean(self._differences)), self._rms.value
        self._rms.add_clipped(mean)
        self.share = mean / (_FACTOR * max(rms, _LEAST))
        if not self.share > 1.0:
            return Contradiction.NONE
        return Contradiction.FRONT_WHEELS if abs(turning_error) > _TURNING else Contradiction.TRAILER
