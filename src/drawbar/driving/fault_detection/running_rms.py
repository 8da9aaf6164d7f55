"""Running RMS of a residual, delayed by two seconds: a fault that is detected within that time does not raise it."""

import math

from drawbar.driving.fault_detection.recent import Recent

MOVES = 0.1
"""speed from which on residuals represent the ground, m/s"""
TIME_CONSTANT = 30.0
"""s"""
_DELAY = 2.0
"""s"""
_CLIP = 2.0
"""times the value so far, at which `add_clipped` clips a sample"""


class RunningRms:
    """Root mean square of samples with exponential forgetting."""

    def __init__(self, sample_time: float, *, prior: float = 0.0, prior_time: float = 0.0) -> None:
        """Begin with a prior.

        Args:
            sample_time: s.
            prior: value, in the unit of the samples.
            prior_time: its weight, s.
        """
        self._share, self._weight, self._square = sample_time / TIME_CONSTANT, prior_time / sample_time, prior**2
        self._newest = Recent[float](_DELAY, sample_time)

    @property
    def value(self) -> float:
        """In the unit of the samples."""
        return math.sqrt(self._square)

    def add(self, value: float) -> None:
        """Add a sample."""
        self._newest.append(value)
        if self._newest.is_full:
            self._weight += 1.0
            self._square += max(self._share, 1.0 / self._weight) * (self._newest[0] ** 2 - self._square)

    def add_clipped(self, value: float) -> None:
        """Add a magnitude, clipped by the value so far: a fault that lasts hardly raises it. Needs a prior."""
        self.add(min(value, _CLIP * self.value))
