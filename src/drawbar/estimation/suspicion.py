"""Which of two antennas is wrong, when they disagree about where the vehicle is."""

import math

from drawbar.estimation.antennas import Antennas, Point
from drawbar.estimation.settings import ScreeningSettings


class Suspicion:
    """Averages how far both antennas lie from their expectations, and watches the difference of the two means.

    What moves the vehicle moves both antennas, so a bump, a slope or a lasting loss leaves the difference alone, and a
    shift too small for a single sample to show adds up (an exponentially weighted moving average, Roberts 1959). The
    antenna whose own mean is larger is suspected, until the difference is small again.
    """

    def __init__(self, settings: ScreeningSettings) -> None:
        self._settings = settings
        self._means: Antennas = ((0.0, 0.0), (0.0, 0.0))
        self.suspect: int | None = None
        """0 the tractor's antenna, 1 the trailer's, None neither"""

    def update(self, offsets: Antennas, outside: tuple[bool, bool], *, deviation: float, room: float) -> None:
        """Take in one sample in which both receivers reported a fix.

        Args:
            offsets: of the fixes from their expectations, ahead and left, m.
            outside: which of them lie outside their gate.
            deviation: of one coordinate, m.
            room: by how much dead reckoning has widened the gates, m.
        """
        limits = self._settings
        most = limits.lateral * deviation  # no single sample counts more than what the gate lets pass
        self._average(offsets, most, limits.memory)
        sudden = outside[0] != outside[1] or not math.dist(*offsets) <= math.sqrt(2.0) * most + room
        limit = limits.shift if self.suspect is None else limits.release
        if not (sudden or math.dist(*self._means) > limit * deviation + room):
            self.suspect = None
        elif self.suspect is None:
            if sudden:
                self._average(offsets, most, 1)  # so that one sample back inside the gate does not clear it
            self.suspect = outside.index(True) if any(outside) else _larger(offsets if sudden else self._means)

    def forget(self) -> None:
        """Begin anew: a receiver reports nothing, and without two antennas there is no disagreement."""
        self._means, self.suspect = ((0.0, 0.0), (0.0, 0.0)), None

    def _average(self, offsets: Antennas, most: float, memory: int) -> None:
        tractor, trailer = zip(self._means, offsets, strict=True)
        self._means = _averaged(*tractor, most, memory), _averaged(*trailer, most, memory)


def _larger(offsets: Antennas) -> int:
    tractor, trailer = (math.hypot(*offset) for offset in offsets)
    return 0 if tractor > trailer else 1


def _averaged(mean: Point, offset: Point, most: float, memory: int) -> Point:
    ahead, left = (old + (min(max(new, -most), most) - old) / memory for old, new in zip(mean, offset, strict=True))
    return ahead, left
