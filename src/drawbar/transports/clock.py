"""The two clocks of received bytes: kernels stamp with the wall clock, drawbar reckons with the monotonic one."""

import time
from collections.abc import Callable

STEP = 0.01
"""a wall clock that moves so far against the monotonic one between two looks was set, s"""
TOGETHER = 1e-4
"""both clocks are read within this time, or once more: the process may have been stopped in between, s"""
ATTEMPTS = 5
OLDEST = 5.0
"""no stamp is older; what seems so is the wall clock's doing, s"""

Clock = Callable[[], float]
"""returns seconds of the monotonic clock"""


class StampConverter:
    """Turns stamps of the wall clock into monotonic time.

    Both clocks are read once for each conversion. Where the wall clock was set in between, or a stamp makes no sense
    (from the future, older than `OLDEST`), the time of the look is returned: late rather than wrong.
    """

    def __init__(self, clock: Clock = time.monotonic, wall_clock: Clock = time.time) -> None:
        self._clock = clock
        self._wall_clock = wall_clock
        now, wall = self._look()
        self._offset = wall - now

    def monotonic(self, stamp: float) -> float:
        """Return the monotonic time of a stamp of the wall clock, both in s."""
        now, wall = self._look()
        moved, self._offset = abs(wall - now - self._offset), wall - now
        age = wall - stamp
        return now - age if moved <= STEP and 0.0 <= age <= OLDEST else now

    def _look(self) -> tuple[float, float]:
        """Return what both clocks show at one instant, as nearly as a busy computer allows."""
        for _ in range(ATTEMPTS):
            before, wall, after = self._clock(), self._wall_clock(), self._clock()
            if after - before <= TOGETHER:
                break
        return after, wall
