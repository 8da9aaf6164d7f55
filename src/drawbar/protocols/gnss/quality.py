"""Quality of the fix, debounced: along trees it flips several times a second.

Policy: a worse quality is accepted at once, a better one after it has held for some time. Driving slows down when a
fix becomes float and must not speed up and slow down again with each flip; a fix just found again may be a wrong one.
"""

from collections import deque

from drawbar.signals import FixQuality


class QualityHold:
    """The worst quality of the last `hold` seconds."""

    def __init__(self, hold: float) -> None:
        self._hold = hold
        self._rising: deque[tuple[float, FixQuality]] = deque()  # each better than the one before

    def update(self, time: float, quality: FixQuality) -> FixQuality:
        """Take the quality of an epoch at a time (s), and return the one to go by."""
        while self._rising and self._rising[-1][1] >= quality:
            self._rising.pop()
        self._rising.append((time, quality))
        while self._rising[0][0] < time - self._hold:
            self._rising.popleft()
        return self._rising[0][1]
