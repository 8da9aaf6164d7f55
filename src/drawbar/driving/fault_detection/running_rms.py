"""Running RMS of a residual, up to a second ago: what a fault has done to it since does not count yet."""

import math
from collections import deque

_LATELY = 30.0
"""over which it is averaged, s"""
_BEFORE = 1.0
"""s"""


class RunningRms:
    """Root mean square of what is given sample by sample, over about half a minute."""

    def __init__(self, sample_time: float, *, first: float = 0.0, first_time: float = 0.0) -> None:
        """Begin with what holds before anything is known.

        Args:
            sample_time: s.
            first: value, in the unit of what is given.
            first_time: for which it counts, s.
        """
        self._share, self._known, self._square = sample_time / _LATELY, first_time / sample_time, first**2
        self._newest = deque[float](maxlen=max(round(_BEFORE / sample_time), 1))

    @property
    def value(self) -> float:
        """In the unit of what is given."""
        return math.sqrt(self._square)

    def add(self, value: float) -> None:
        """Take in a sample."""
        self._newest.append(value)
        if len(self._newest) == self._newest.maxlen:
            self._known += 1.0
            self._square += max(self._share, 1.0 / self._known) * (self._newest[0] ** 2 - self._square)
