"""The clocks: the computer's monotonic one, a stand-in's faster one, and the wall clock of the kernel's stamps."""

import math
import select
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

from drawbar.nanoseconds import seconds

STEP = 0.01
"""a wall clock that moves so far against the monotonic one between two looks was set, s"""
TOGETHER = 1e-4
"""both clocks are read within this time, or once more: the process may have been stopped in between, s"""
ATTEMPTS = 5
OLDEST = 5.0
"""no stamp is older; what seems so is the wall clock's doing, s"""
FASTEST = 10
"""largest pace of a stand-in"""

Clock = Callable[[], float]
"""returns seconds of the monotonic clock"""


@dataclass(frozen=True, slots=True)
class MachineClock:
    """Time of a drive, the same in all of its processes: the monotonic clock's, times the pace of a stand-in.

    The pace is a whole number, so that no process rounds otherwise than another. A machine's is 1.
    """

    pace: int = 1
    zero: int = 0
    """what counts as 0, ns"""

    def __call__(self) -> float:
        """Return the time, s."""
        return seconds(self.nanoseconds())

    def nanoseconds(self) -> int:
        """Return the time, ns."""
        return time.monotonic_ns() * self.pace - self.zero

    def from_now(self) -> Self:
        """Return a clock of the same pace that shows 0 now."""
        return replace(self, zero=self.zero + self.nanoseconds())

    def wait(self, descriptors: Sequence[Any], duration: float) -> bool:
        """Wait until one of the descriptors can be read, for so many of its own seconds at most; return whether."""
        return bool(select.select(descriptors, [], [], max(duration, 0.0) / self.pace)[0])


class StampConverter:
    """Turns stamps of the wall clock into monotonic time, or that of a stand-in.

    Both clocks are read once for each conversion. Where the wall clock was set in between, or a stamp makes no sense
    (from the future, older than `OLDEST`, of the time before the clock was set forwards), the time of the look is
    returned: late rather than wrong.
    """

    def __init__(self, clock: Clock = time.monotonic, wall_clock: Clock = time.time) -> None:
        self._clock = clock
        self._wall_clock = wall_clock
        self._pace = clock.pace if isinstance(clock, MachineClock) else 1
        now, wall = self._look()
        self._offset = wall - now / self._pace
        self._set_from = -math.inf
        """what the wall clock showed before it was last set forwards, s"""

    def monotonic(self, stamp: float) -> float:
        """Return the monotonic time of a stamp of the wall clock, both in s."""
        now, wall = self._look()
        offset = wall - now / self._pace
        moved, self._offset = offset - self._offset, offset
        if moved > STEP:
            self._set_from = wall - moved
        age = wall - stamp
        known = abs(moved) <= STEP and 0.0 <= age <= OLDEST and stamp > self._set_from
        return now - age * self._pace if known else now

    def _look(self) -> tuple[float, float]:
        """Return what both clocks show at one instant, as nearly as a busy computer allows."""
        for _ in range(ATTEMPTS):
            before, wall, after = self._clock(), self._wall_clock(), self._clock()
            if after - before <= TOGETHER * self._pace:
                break
        return after, wall
