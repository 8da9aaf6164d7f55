"""Tube exit: for how long a body has been outside its tube, in which alone the limits are promised.

Ordinary driving leaves it for 0.8 s at most: `drawbar experiment ground` and `robustness`, once the line is reached.
"""

from drawbar.safety.causes import Cause
from drawbar.signals import StepRecord

_AFTER, _LOST_AFTER = 1.0, 2.0
"""outside the tube in every sample, after which the vehicle is slowed down, and stopped, s"""


class TubeExit:
    """The time since either body has left its tube."""

    def __init__(self, sample_time: float) -> None:
        """Begin inside; `sample_time` in s."""
        self._after, self._lost_after = (round(time / sample_time) for time in (_AFTER, _LOST_AFTER))
        self._outside = 0

    def update(self, record: StepRecord, *, engaged: bool) -> None:
        """Update with a step; without a declared tube, or not engaged, nothing is outside."""
        margins = record.tractor_steering.margin, record.trailer_steering.margin
        leaves = engaged and any(margin < 0.0 for margin in margins)
        self._outside = self._outside + 1 if leaves else 0

    @property
    def notices(self) -> tuple[int, ...]:
        """Codes of what is to be told."""
        if self._outside < self._after:
            return ()
        return ((Cause.OUTSIDE_TUBE if self._outside < self._lost_after else Cause.TUBE_LOST).value,)
