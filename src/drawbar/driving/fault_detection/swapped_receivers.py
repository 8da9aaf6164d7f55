"""Swapped receivers: the trailer's antenna moves ahead of the tractor's.

Detected by the direction of the motion alone, so not before the vehicle moves, and indistinguishable from rolling
backwards: both end when it drives forwards, or the receivers are exchanged.
"""

import math

from drawbar.driving.fault_detection.position_drift import fixed_motion
from drawbar.messages import Fixes

_AGAINST = -0.5
"""cosine between the way of each antenna and the line from the trailer's to the tractor's, below which it is against"""
_EPOCHS = 2
"""in a row: before the estimator rejects both positions, where they have changed places while driving"""


class SwappedReceivers:
    """Direction of the motion over the last epochs; kept while nothing moves."""

    def __init__(self) -> None:
        """Begin without an epoch."""
        self._against = 0

    @property
    def found(self) -> bool:
        """Whether the receivers are swapped, or the vehicle rolls backwards."""
        return self._against >= _EPOCHS

    def receive_fixes(self, fixes: Fixes) -> None:
        """Update with an epoch; one without both positions or any motion is ignored."""
        x, y, velocity = fixed_motion(fixes.tractor)
        behind_x, behind_y, drawn = fixed_motion(fixes.trailer)
        ahead = (x - behind_x, y - behind_y)
        along = [each for each in (_cosine(ahead, way) for way in (velocity, drawn)) if math.isfinite(each)]
        if along:
            self._against = self._against + 1 if max(along) < _AGAINST else 0


def _cosine(one: tuple[float, float], other: tuple[float, float]) -> float:
    """Return the cosine between two directions; NaN where one is none."""
    lengths = math.hypot(*one) * math.hypot(*other)
    return (one[0] * other[0] + one[1] * other[1]) / lengths if lengths > 0.0 else math.nan
