"""Cadence: when the next of a series of messages is due, however often it is asked."""

import math

_EARLY = 0.002
"""how much too early a message may go, so that a tick of the same period that comes a little early is not missed, s"""
_NEWS_EARLY = 0.2
"""how much too early a message with news may go, of the period: it need not wait for another tick, and from then on
messages go with the news"""


class Cadence:
    """Messages of one period. No tick is caught up: after a gap the period restarts."""

    def __init__(self, period: float) -> None:
        self.period = period
        self._due = -math.inf

    def due(self, time: float, *, news: bool = False) -> bool:
        """Return whether a message is to go now, and count it as gone; one with new content may go earlier."""
        if time < self._due - (_NEWS_EARLY * self.period if news else _EARLY):
            return False
        late = time - self._due
        self._due = self._due + self.period if 0.0 <= late < self.period else time + self.period
        return True

    def restart(self, time: float) -> None:
        """Count a message that went now out of turn."""
        self._due = time + self.period
