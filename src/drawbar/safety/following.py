"""Following: whether a steering follows its set points, and its angle moves as a steering can. Pure, without numpy.

Judged on a window of the last ticks. A steering that hardly moves while its set point is far from it is stuck, on
whichever side the set point is: it may change sides meanwhile. So is one that is less far off, but for longer, and
rests: a steering that always stands off moves as its set point does, one within its dead band is nearer. One whose set
point is on the same side all the time, and which goes away from it, and still does, is reversed; the last because a
steering with dead time continues for a moment after its set point has changed sides.

One that goes away from its set point for as long as a stuck one rests, and still does, is told more than is measured:
it follows, and stands off. How far it does is remembered, and it may be further off by that, within a bound, before it
is stuck. A steering that is stuck goes nowhere, and a sound one goes towards its set point: neither is forgiven any.

An angle that goes further from one reading to the next than any steering turns, and stays there, is that of a sensor
that has slipped: the board's own loop has followed it.
"""

import math
from collections import deque
from statistics import fmean

from drawbar.safety.settings import DriveSettings

_LONGER, _NEARER, _STILLER = 4.0, 2.0 / 3.0, 0.2
"""time, distance and movement of a stuck steering that is less far off, as shares of those in the settings; that
distance is also the most by which one that stands off is forgiven"""
_ASIDE = math.radians(1.0)
"""a set point so far from the measured angle is on one side of it for certain, rad"""
_LATEST = 0.12
"""time in which a reversed steering must still move away, s"""


class Following:
    """Set point minus measured angle of one steering over the last seconds."""

    def __init__(self, settings: DriveSettings) -> None:
        """Begin without a sample."""
        self._settings = settings
        self._samples: deque[tuple[float, float, float]] = deque()
        self._longest = max(_LONGER * settings.stuck_time, settings.reversed_time, _LATEST)
        self.reset()

    def reset(self) -> None:
        """Forget: the steering is not asked for anything."""
        self._samples.clear()
        self._read, self._leapt = (math.nan, math.nan), False  # the newest reading: s, rad
        self._off = 0.0  # how far it stands off its set point while it follows, rad
        self.stuck = self.reversed = self.jumped = False

    def add(self, time: float, set_point: float, measured: float, read: float) -> None:
        """Take in what is asked for at a time, and what was measured when it was read; s, rad."""
        settings = self._settings
        self._look_at(read, measured)
        self._samples.append((time, set_point - measured, measured))
        while len(self._samples) > 1 and time - self._samples[1][0] > self._longest:
            self._samples.popleft()
        self._learn()
        self.stuck |= self._rests()
        moved, apart = self._moved(settings.reversed_time, _ASIDE)
        # what stays apart by the same moves away only because its set point does
        self.reversed |= max(moved, -apart) < -settings.reversed_angle and self._moved(_LATEST, _ASIDE)[0] < 0.0

    def _look_at(self, time: float, angle: float) -> None:
        """Take in a reading, again or for the first time; one that leaps there and back is a flaw of itself."""
        (before, last), self._read = self._read, (time, angle)
        if time == before:
            return
        leaps = abs(angle - last) > self._settings.jump_angle + self._settings.jump_rate * (time - before)
        self.jumped |= self._leapt and not leaps
        self._leapt = leaps and not self._leapt

    def _learn(self) -> None:
        """Learn how far it stands off, where it goes away from a set point that is on one side of it all the time."""
        time, apart, move = self._settings.stuck_time, self._settings.stuck_angle, self._settings.stuck_move
        if self._moved(time, 0.0)[0] <= -move and self._moved(_LATEST, 0.0)[0] < 0.0:
            self._off = min(fmean(abs(gap) for _, gap, _ in self._window(time)), _NEARER * apart)

    def _rests(self) -> bool:
        """Return whether it hardly moved while it was far from its set point, or rested while it was less far."""
        time, apart, move = self._settings.stuck_time, self._settings.stuck_angle, self._settings.stuck_move
        far, less_far = apart + self._off, _NEARER * apart + self._off
        hardly = self._moved(time, far)[0] < move or self._stays(time, far, move)
        return hardly or self._stays(_LONGER * time, less_far, _STILLER * move)

    def _stays(self, span: float, least: float, move: float) -> bool:
        """Return whether it moved less either way over a span while it was so far from its set point, on the average.

        In both halves of the time, so that a set point that has just jumped does not count.
        """
        window = self._window(span)
        gaps, angles = [abs(gap) for _, gap, _ in window], [angle for _, _, angle in window]
        apart = min(fmean(gaps[: len(gaps) // 2]), fmean(gaps[len(gaps) // 2 :])) if len(gaps) > 1 else 0.0
        return apart >= least and max(angles) - min(angles) < move

    def _moved(self, span: float, least: float) -> tuple[float, float]:
        """Return how far it moved towards its set point, and how much further apart they are, over a span, rad.

        Infinity where it was not at least so far apart from its set point all the time, always on the same side.
        """
        window = self._window(span)
        side = 1.0 if window and window[0][1] > 0.0 else -1.0
        if not window or not all(side * gap >= least for _, gap, _ in window):
            return math.inf, math.inf
        return side * (window[-1][2] - window[0][2]), side * (window[-1][1] - window[0][1])

    def _window(self, span: float) -> list[tuple[float, float, float]]:
        """Return the samples of the last span, s; none where it has not yet been observed for that long."""
        window = [sample for sample in self._samples if self._samples[-1][0] - sample[0] <= span]
        return window if len(window) < len(self._samples) else []
