"""Rollback: the last seconds are computed again without what has turned out to be wrong.

A wrong sensor bends the estimate before it is seen, and a bent one takes seconds to straighten, in which the vehicle is
steered beside its line. So what the autopilot remembered at each of the last samples is kept, and from the oldest on it
is given the same measurements again, without what is excluded. The commands that come of it are not sent.
"""

from collections import deque
from collections.abc import Callable

from drawbar.signals import Measurement
from drawbar.step.autopilot import Autopilot

SPAN = 2.0
"""s"""


class Rollback:
    """The last samples of an autopilot."""

    def __init__(self, autopilot: Autopilot, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._autopilot = autopilot
        self._samples = deque[tuple[tuple[bytes, ...], Measurement]](maxlen=max(round(SPAN / sample_time), 1))

    def keep(self, measurement: Measurement) -> None:
        """Keep what the autopilot remembers, and the measurement that it is given next."""
        self._samples.append((self._autopilot.remember(), measurement))

    def clear(self) -> None:
        """Forget: the autopilot was told something else than measurements."""
        self._samples.clear()

    def recompute(self, change: Callable[[Measurement], Measurement]) -> None:
        """Let the autopilot take in what becomes of the kept measurements, once, in the place of what it was given."""
        for i, (memory, measurement) in enumerate(self._samples):
            if i == 0:
                self._autopilot.recall(memory)
            self._autopilot.feedback(change(measurement))
            self._autopilot.prepare()
        self.clear()
