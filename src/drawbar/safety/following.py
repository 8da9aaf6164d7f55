"""Following: whether a steering goes where it is told. Pure, without numpy.

Judged on a window of the last ticks during which the set point was always on the same side of the measured angle: a
steering that is told to go left the whole time and hardly moves is stuck; one that goes right, and away, is reversed.
"""

import math
from collections import deque

from drawbar.safety.settings import DriveSettings


class Following:
    """Set point minus measured angle of one steering over the last second or so."""

    def __init__(self, settings: DriveSettings) -> None:
        """Begin without a sample."""
        self._settings = settings
        self._samples: deque[tuple[float, float, float]] = deque(maxlen=256)
        self.stuck = False
        self.reversed = False

    def reset(self) -> None:
        """Forget: the steering is not asked for anything."""
        self._samples.clear()
        self.stuck = self.reversed = False

    def add(self, time: float, set_point: float, measured: float) -> None:
        """Take in what was asked for and what was measured at a time; s, rad."""
        settings = self._settings
        self._samples.append((time, set_point - measured, measured))
        moved, _ = self._moved(settings.stuck_time, settings.stuck_angle)
        self.stuck |= moved < settings.stuck_move
        moved, apart = self._moved(settings.reversed_time, settings.reversed_angle)
        # what stays apart by the same moves away only because its set point does
        self.reversed |= moved < -settings.reversed_angle and apart > settings.reversed_angle

    def _moved(self, span: float, least: float) -> tuple[float, float]:
        """Return how far it moved towards its set point, and how much further apart they are, over a span, rad.

        Infinity where it was not at least so far apart from its set point all the time, always on the same side.
        """
        now = self._samples[-1][0]
        window = [sample for sample in self._samples if now - sample[0] <= span]
        if len(window) == len(self._samples):
            return math.inf, math.inf  # not yet observed for that long
        side = 1.0 if window[0][1] > 0.0 else -1.0
        if not all(side * gap >= least for _, gap, _ in window):
            return math.inf, math.inf
        return side * (window[-1][2] - window[0][2]), side * (window[-1][1] - window[0][1])
