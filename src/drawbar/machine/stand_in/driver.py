"""Driver of the stand-in machine: the speed that somebody on the seat would choose."""

import math

from drawbar.machine.stand_in.world import TICK


class Driver:
    """Somebody on the seat: creeps until the boards steer, then drives; stops a moment after they release."""

    CREEP = 0.3
    """m/s; estimators need motion to find the heading"""
    PUSHED = 0.8
    """while a bare valve is calibrated, m/s"""
    WAIT = 5.0
    """for which the vehicle stands at first, once somebody is there who could steer, s"""
    WAIT_UNTOLD = 15.0
    """the same where nobody asks it to stand until the emergency stop has been tried, s"""
    ACCELERATION, DECELERATION = 0.5, 1.5
    """m/s²"""
    REACTION = 0.7
    """s"""
    BRAKES = 3.0
    """fastest that a tractor slows down that keeps a commanded speed, m/s²"""

    def __init__(self, speed: float) -> None:
        """Take the speed at which to drive, m/s."""
        self._speed, self._released_at, self._came = speed, math.inf, 0.0
        self.reaction = self.REACTION
        """after which it stops, s"""
        self.wait = self.WAIT
        """for which it stands at first, s"""
        self.steered = False
        """the boards have steered since it began"""
        self.speed = 0.0
        self.stop_requested = False
        """by the display"""

    @property
    def creeps(self) -> bool:
        """He drives before the boards steer, and steers himself."""
        return self.speed > 0.0 and not self.steered

    def attend(self, time: float, *, attended: bool) -> None:
        """Stand while nobody is there who could steer, and begin again with the next who is; without this, creep.

        Args:
            time: s.
            attended: somebody commands the steerings, even if only not to steer, or sends the gate's state.
        """
        if attended:
            self._came = min(self._came, time)
        elif not self.steered or self.speed == 0.0:
            self._came = math.inf
            self.stop_requested = False  # by a drive that is over
            self.begin_again()

    def begin_again(self) -> None:
        """Creep once more, after the boards have released and the vehicle stands."""
        self.steered, self._released_at = False, math.inf

    def tick(self, time: float, steered: bool, commanded: float | None = None, *, pushed: bool = False) -> None:
        """Decide on the speed at a time, s.

        Args:
            time: s.
            steered: both steerings follow set points.
            commanded: speed that the tractor itself keeps to, m/s; None: the driver drives.
            pushed: a bare valve is being calibrated.
        """
        self.steered |= steered
        if (steered and not self.stop_requested) or (not self.steered and not self.stop_requested):
            self._released_at = math.inf
        else:
            self._released_at = min(self._released_at, time)
        wish = self._speed if steered or self.steered else self.CREEP if time >= self._came + self.wait else 0.0
        if self.stop_requested:
            self._released_at = min(self._released_at, time)
        if time - self._released_at >= self.reaction:
            wish = 0.0
        wish = self.PUSHED if pushed and not self.stop_requested else wish
        wish = wish if commanded is None else commanded
        slows = self.DECELERATION if commanded is None else self.BRAKES
        step = TICK * (self.ACCELERATION if wish > self.speed else slows)
        self.speed += min(max(wish - self.speed, -step), step)
