"""Following: whether a steering goes where it is told. Pure, without numpy.

Judged on a window of the last ticks during which the set point was always on the same side of the measured angle: a
steering that is told to go left the whole time and hardly moves is stuck; one that goes right is reversed.
"""

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
        self.stuck |= self._moved(settings.stuck_time, settings.stuck_angle, settings.stuck_move)
        self.reversed |= self._moved(settings.reversed_time, settings.reversed_angle, -settings.reversed_angle)

    def _moved(self, span: float, apart: float, least: float) -> bool:
        """Return whether, over a span in which it was apart from its set point, it moved there by less than it must."""
        now = self._samples[-1][0]
        window = [sample for sample in self._samples if now - sample[0] <= span]
        if len(window) == len(self._samples):
            return False  # not yet observed for that long
        side = 1.0 if window[0][1] > 0.0 else -1.0
        if not all(side * gap >= apart for _, gap, _ in window):
            return False
        return side * (window[-1][2] - window[0][2]) < least
