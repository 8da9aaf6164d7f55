"""Following: whether a steering follows its set points, and its angle moves as a steering can. Pure, without numpy.

Judged on a window of the last ticks:

- Stuck: it hardly moves while its set point is far away, on whichever side (which may change meanwhile); or it rests
  after its set point has been far away, or for longer while that is less far away. A steering with a steady error moves
  as its set point does, and one within its dead band is nearer.
- Reversed: its set point is on one side all the time, and it moves away from it, also at the end of the window: a
  steering with dead time continues for a moment after its set point has changed sides.
- Jumped: its angle changes between two readings by more than any steering turns, and stays there: the sensor has
  slipped, and the board's own loop has followed it.

A steering that moves away from a set point on one side for as long as a stuck one rests follows with an offset, as when
the sensor's zero is wrong. That offset, within a bound, is added to the distances from which on it is stuck. A stuck
steering does not move, and a sound one moves towards its set point: neither has an offset.
"""

import math
from collections import deque
from statistics import fmean

from drawbar.safety.settings import DriveSettings

_LONG, NEAR, _REST = 4.0, 2.0 / 3.0, 0.2
"""time, distance and movement of a stuck steering near its set point, as shares of those in the settings; that distance
is also the bound of the offset"""
_SIDE = math.radians(1.0)
"""least distance at which a set point is on one side of the measured angle for certain, rad"""
_LATEST = 0.12
"""time in which a reversed steering must still move away, s"""


class Following:
    """Set point minus measured angle of one steering over the last seconds."""

    def __init__(self, settings: DriveSettings) -> None:
        """Begin without a sample."""
        self._settings = settings
        self._samples: deque[tuple[float, float, float]] = deque()
        self._longest = max(_LONG * settings.stuck_time, settings.reversed_time, _LATEST)
        self.reset()

    def reset(self) -> None:
        """Forget all samples: the steering is released."""
        self._samples.clear()
        # the newest reading, s, rad; the offset of set points from angles while it follows, rad
        self._read, self._offset = (math.nan, math.nan), 0.0
        self._pending = self.stuck = self.reversed = self.jumped = False

    def add(self, time: float, set_point: float, measured: float, read: float) -> None:
        """Add a set point, and the measured angle with the time at which it was read; s, rad."""
        settings = self._settings
        self._check_reading(read, measured)
        self._samples.append((time, set_point - measured, measured))
        while len(self._samples) > 1 and time - self._samples[1][0] > self._longest:
            self._samples.popleft()
        self._update_offset()
        self.stuck |= self._rests()
        moved, apart = self._moved(settings.reversed_time, _SIDE)
        # at a constant distance it moves away only because its set point does
        self.reversed |= max(moved, -apart) < -settings.reversed_angle and self._moved(_LATEST, _SIDE)[0] < 0.0

    def _check_reading(self, time: float, angle: float) -> None:
        """Check a reading, new or repeated; a jump is confirmed by the next reading, a single outlier is ignored."""
        (before, last), self._read = self._read, (time, angle)
        if time == before:
            return
        jumps = abs(angle - last) > self._settings.jump_angle + self._settings.jump_rate * (time - before)
        self.jumped |= self._pending and not jumps
        self._pending = jumps and not self._pending

    def _update_offset(self) -> None:
        """Update the offset while it moves away from a set point that is on one side of it all the time."""
        time, apart, move = self._settings.stuck_time, self._settings.stuck_angle, self._settings.stuck_move
        if self._moved(time, 0.0)[0] <= -move and self._moved(_LATEST, 0.0)[0] < 0.0:
            self._offset = min(fmean(abs(gap) for _, gap, _ in self._window(time)), NEAR * apart)

    def _rests(self) -> bool:
        """Return whether it hardly moved far from its set point, or rested near it for longer."""
        time, apart, move = self._settings.stuck_time, self._settings.stuck_angle, self._settings.stuck_move
        far, near = apart + self._offset, NEAR * apart + self._offset
        still = self._moved(time, far)[0] < move or self._stays(time, far, move)
        return (
            still or self._stays(time, far, _REST * move, early=True) or self._stays(_LONG * time, near, _REST * move)
        )

    def _stays(self, span: float, least: float, move: float, *, early: bool = False) -> bool:
        """Return whether it moved less over a span while its mean distance from the set point was at least so large.

        In both halves of the span, so that a set point that has just changed does not count; or, `early`, in its first
        third, after which dead time is over.
        """
        window = self._window(span)
        gaps, angles = [abs(gap) for _, gap, _ in window], [angle for _, _, angle in window]
        half, third = len(gaps) // 2, len(gaps) // 3
        parts = (gaps[:third],) if early else (gaps[:half], gaps[half:])
        return third > 0 and min(map(fmean, parts)) >= least and max(angles) - min(angles) < move

    def _moved(self, span: float, least: float) -> tuple[float, float]:
        """Return its movement towards its set point, and the change of their distance, over a span, rad.

        Infinity where the distance was not always at least so large, on the same side.
        """
        window = self._window(span)
        side = 1.0 if window and window[0][1] > 0.0 else -1.0
        if not window or not all(side * gap >= least for _, gap, _ in window):
            return math.inf, math.inf
        return side * (window[-1][2] - window[0][2]), side * (window[-1][1] - window[0][1])

    def _window(self, span: float) -> list[tuple[float, float, float]]:
        """Return the samples of the last span, s; none where there are not yet so many."""
        window = [sample for sample in self._samples if self._samples[-1][0] - sample[0] <= span]
        return window if len(window) < len(self._samples) else []
