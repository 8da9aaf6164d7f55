"""Contradicting speeds: the wheels' speed is not that of the tractor's antenna.

An encoder whose cable is cut reports standing wheels, and its report is not missing. Which of both is wrong is not
known (a receiver may report knots), and positions tell more than either. The gate, which is told both, stops.
"""

import math

from drawbar.messages import Fixes

_DIFFERENCE, _RATIO = 0.3, 1.5
"""where both are more, in m/s and as a ratio, one of them is wrong; slip makes less"""


class ContradictingSpeeds:
    """The newest epoch that had both speeds."""

    def __init__(self) -> None:
        """Begin without an epoch."""
        self.found = False
        """they contradict each other"""

    def receive_fixes(self, fixes: Fixes) -> None:
        """Update with an epoch; one without the antenna's speed changes nothing."""
        if math.isfinite(fixes.tractor_speed):
            slower, faster = sorted((abs(fixes.wheel_speed), fixes.tractor_speed))
            self.found = faster - slower > _DIFFERENCE and faster > _RATIO * slower
