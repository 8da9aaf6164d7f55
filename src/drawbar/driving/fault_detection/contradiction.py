"""Contradiction: what the detectors of wrong angles see together, and which sensor is wrong.

Each may see a part of one wrong angle: of one that drifts all come near their limits before one exceeds its own. Where
the tractor does not turn as its front wheels are measured, theirs is the wrong sensor, unless the hitch sensor rather
looks reversed: that bends the estimated turns as well. Whether else hitch or joint is wrong is not observable.
"""

import math
from enum import Enum
from typing import NamedTuple

_TOGETHER, _REVERSED = 1.25, 0.5
"""norm of all shares that is a contradiction, and weight of a reversed hitch sensor's: without a fault it comes to 0.9
of that (experiments/faults/ordinary.py)"""
_TURNING = math.radians(3.3)
"""turning error beyond which the front wheels' sensor is the wrong one, rad"""


class Shares(NamedTuple):
    """What each detector of wrong angles sees, as a share of what is a contradiction."""

    residuals: float = 0.0
    """of hitch and joint"""
    reversed: float = 0.0
    """of a hitch sensor that is"""
    angles: float = 0.0
    """to which wheels and joint lead"""
    turning: float = 0.0
    """of the tractor, beside its front wheels"""

    @property
    def together(self) -> float:
        """Their norm, as a share of one that is a contradiction."""
        return math.hypot(self.residuals, _REVERSED * self.reversed, self.angles, self.turning) / _TOGETHER


class Contradiction(Enum):
    """Which sensor contradicts."""

    NONE = 0
    TRAILER = 1
    """of hitch or joint"""
    FRONT_WHEELS = 2


def contradiction(shares: Shares, turning_error: float, *, astray: bool) -> Contradiction:
    """Return what contradicts where the estimate may have followed any sensor.

    Args:
        shares: of all detectors.
        turning_error: rad, NaN: unknown (turning_error.py).
        astray: the estimate moves in another direction than the tractor's antenna.
    """
    if not (shares.angles > 1.0 or shares.together > 1.0 or astray):
        return Contradiction.NONE
    turns_otherwise = abs(turning_error) > _TURNING and shares.turning >= shares.reversed
    return Contradiction.FRONT_WHEELS if turns_otherwise else Contradiction.TRAILER
