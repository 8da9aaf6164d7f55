"""Timing of a receiver: its time against the monotonic clock, and how its epochs follow each other."""

import math
from collections import deque

from drawbar.protocols.gnss.messages import DAY

SAME_EPOCH = 0.005
"""times closer than this are one epoch, s: sentences round to 1 or 10 ms, no receiver measures faster"""
_WINDOW = 60
"""s over which the least delay is looked for"""
_DRIFT = 5e-4
"""by which the monotonic clock may run faster than the receiver's, as much as NTP's discipline may make it"""


def difference(later: float, earlier: float) -> float:
    """Return later minus earlier (seconds of the UTC day) in [-43200, 43200) s, across midnight and a leap second."""
    step = (later - earlier + DAY / 2.0) % DAY - DAY / 2.0
    return step + 1.0 if earlier >= DAY > later else step


class ReceiverClock:
    """The receiver's time in the monotonic clock: t_measured = t_gnss + min(t_received - t_gnss) over 60 s.

    The minimum takes queues and the scheduler away; the constant part of the delay stays and is configured. It grows no
    faster than clocks drift, so that a line which has become slower is known to be.
    """

    def __init__(self) -> None:
        self._utc = math.nan
        self._elapsed = self._received = 0.0
        self._least: deque[tuple[int, float]] = deque(maxlen=_WINDOW)  # (second, least offset in it)
        self._offset = math.inf

    def step(self, utc: float) -> float:
        """Return the seconds from the last epoch to this time; infinite before the first."""
        return math.inf if math.isnan(self._utc) else difference(utc, self._utc)

    def offset(self, utc: float, received: float) -> float:
        """Return a time's offset from the monotonic one, s, if an epoch of it was received at that time (s)."""
        return received - self._elapsed - self.step(utc)

    def lead(self, utc: float, received: float) -> float:
        """Return by how much an epoch comes earlier than the least delay of 60 s allows, s; -inf: none is known."""
        self._forget_before(math.floor(received) - _WINDOW)
        return self._offset - self.offset(utc, received) if self._least else -math.inf

    def measured(self, utc: float, received: float) -> float:
        """Take an epoch later than all before, received at a monotonic time (s); return when it was measured (s)."""
        step = self.step(utc)
        self._elapsed += step if math.isfinite(step) else 0.0
        self._utc = utc
        self._forget_before(math.floor(received) - _WINDOW)
        if not self._least:
            self._offset = math.inf
        grown = self._offset + _DRIFT * max(received - self._received, 0.0)
        self._received = received
        self._offset = min(self._least_with(received - self._elapsed, math.floor(received)), grown)
        return self._elapsed + self._offset

    def _forget_before(self, second: int) -> None:
        while self._least and self._least[0][0] <= second:
            self._least.popleft()

    def _least_with(self, offset: float, second: int) -> float:
        """Return the least offset that is remembered, this one too."""
        if self._least and self._least[-1][0] == second:
            offset = min(offset, self._least.pop()[1])
        self._least.append((second, offset))
        return min(least for _, least in self._least)

    def forget(self) -> None:
        """Forget the delays so far: a receiver without a fix may have meant another time."""
        self._least.clear()
