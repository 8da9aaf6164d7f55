"""Board replies: what is known of one steer board, and of other computers that command it, from what they send."""

import math

from drawbar.protocols.agopengps.steering import SteerReply
from drawbar.protocols.swings import Swings

LARGEST_ANGLE = math.radians(49.995)
"""boards release above 50°, and report nothing larger, rad"""
LARGEST_JUMP = math.radians(5.0)
"""between two replies 0.1 s or less apart, rad"""
_JUMP_RATE = math.radians(50.0)
"""between replies further apart, rad/s: no steering is as fast"""
_FRESH = 0.5
"""age of a reply after which the board counts as silent, s"""
_SILENCE = 0.2
"""age of a reply after which a board that steers is released, s"""
_SLOWEST = 0.2
"""interval of set points beyond which replies are not waited for any longer, s"""
_ANSWER = 0.05
"""for a set point and its reply to travel, s"""


class BoardReplies:
    """One board's replies."""

    def __init__(self, *, address: str, inverted: bool, own: frozenset[str]) -> None:
        self.angle = math.nan
        """measured, rad, left positive"""
        self.wire_angle = 0.0
        """the last plausible one as the board counts it; 0 before the first"""
        self.time = -math.inf
        """of the last reply"""
        self.steer_off = True
        """the board will not steer"""
        self.plausible = False
        """the last reply's angle can be true"""
        self.swings = Swings()
        self._host, _, self._port = address.partition(":")
        self._sign = -1.0 if inverted else 1.0
        self._own = own
        self._jumped = -math.inf
        self._since = math.inf
        self._asked = math.inf
        self._master = -math.inf

    def is_board(self, source: str) -> bool:
        """Return whether `source`, an `address:port`, is the board."""
        host, _, port = source.partition(":")
        return host == self._host and self._port in ("", port)

    def take_master(self, time: float, source: str) -> bool:
        """Take in that `source` sends set points; return whether it sends them to this board's network."""
        if source in self._own:
            return True
        if _network(source.partition(":")[0]) != _network(self._host):
            return False
        self._master = time
        return True

    def take_reply(self, time: float, reply: SteerReply) -> bool:
        """Take in a reply; return whether its angle can be true after the one before."""
        before, elapsed = self.angle, time - self.time
        if not elapsed <= _FRESH:
            before, self._since = math.nan, time
            self.swings.forget()
        self.angle = self._sign * reply.angle
        self.swings.see(self.angle)
        self.time, self.steer_off, self._asked = time, reply.steer_off, math.inf
        jumped = abs(self.angle - before) > max(LARGEST_JUMP, _JUMP_RATE * elapsed)
        self._jumped = time if jumped else self._jumped
        self.plausible = abs(self.angle) < LARGEST_ANGLE
        if self.plausible:
            self.wire_angle = reply.angle
        return self.plausible and not jumped

    def jumped_within(self, time: float, duration: float) -> bool:
        """Return whether an angle within the last `duration` s could not be true after the one before."""
        return time - self._jumped < duration

    def ask(self, time: float) -> None:
        """Note that a set point goes out, which the board answers."""
        self._asked = min(self._asked, time)

    def fresh(self, time: float) -> bool:
        """Return whether the board replies."""
        return time - self.time <= _FRESH

    def duration(self, time: float) -> float:
        """Return how long the board has replied without a break, s."""
        return time - self._since

    def silent(self, time: float, interval: float) -> bool:
        """Return whether replies are missing that must have come, to set points every `interval` s.

        200 ms; more than two replies where set points are slower than 12.5 Hz.
        """
        patience = max(_SILENCE, 2.5 * min(interval, _SLOWEST))
        return time - self.time > patience and time - self._asked > _ANSWER

    def master_within(self, time: float, duration: float) -> bool:
        """Return whether another computer has sent set points within the last `duration` s."""
        return time - self._master < duration


def _network(host: str) -> str:
    """Return the part of an address by which networks of boards differ: all are /24; the loopback is one."""
    return "127" if host.startswith("127.") else host.rpartition(".")[0]
