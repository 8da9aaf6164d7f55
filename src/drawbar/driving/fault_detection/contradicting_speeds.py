"""Contradicting speeds: the wheels' speed is not that of the tractor's antenna, or falls faster than a vehicle stops.

An encoder whose cable is cut reports standing wheels, and its report is not missing. Which of both is wrong is not
known (a receiver may report knots), and positions are more reliable than either. The gate, which receives both, stops.
Where no receiver reports, nothing else shows that the vehicle moves: without a speed its position is soon too unsure,
and it is stopped.
"""

import math
from collections import deque

from drawbar.messages import Fixes
from drawbar.nanoseconds import seconds

_DIFFERENCE, _RATIO = 0.3, 1.5
"""where both are more, in m/s and as a ratio, one of them is wrong; slip makes less"""
_HARD = 3.0
"""deceleration beyond which wheels do not show the vehicle's speed: their cable is cut, or they lock, m/s²"""
_REMEMBERED = 0.5
"""for which speeds of the wheels are compared with the newest, s"""


class ContradictingSpeeds:
    """The newest epoch that had both speeds, and wheels that stopped at once since."""

    def __init__(self) -> None:
        """Begin without an epoch."""
        self.found = False
        """they contradict each other, or the wheels what they reported before"""
        self._wheels: deque[tuple[float, float]] = deque()  # s, m/s

    def receive_fixes(self, fixes: Fixes) -> None:
        """Update with an epoch, or a report of the wheels alone; without the antenna's speed nothing is cleared."""
        wheels, time = abs(fixes.wheel_speed), seconds(fixes.wheel_speed_time)
        if math.isfinite(fixes.tractor.speed):
            slower, faster = sorted((wheels, fixes.tractor.speed))
            self.found = faster - slower > _DIFFERENCE and faster > _RATIO * slower
        else:
            self.found |= wheels < _DIFFERENCE and self._stopped_hard(time, wheels)
        if math.isfinite(wheels):
            self._wheels.append((time, wheels))
        while self._wheels and time - self._wheels[0][0] > _REMEMBERED:
            self._wheels.popleft()

    def _stopped_hard(self, time: float, wheels: float) -> bool:
        return any(before - wheels > _DIFFERENCE + _HARD * (time - at) for at, before in self._wheels)
