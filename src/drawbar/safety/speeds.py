"""Speeds: the speed to be safe with. Pure, without numpy."""

import math
from collections import deque
from statistics import fmean

from drawbar.safety.settings import SafetySettings

_SMALL = 0.1
"""a difference of two speeds below which their ratio means nothing: noise, or the delay of one of them, m/s"""
_RECENT = 3.0
"""longest time of a source's samples whose mean is compared with another's: the vehicle's speed changes, s"""


class Speeds:
    """The speed to be safe with: the largest of the last samples of both sources."""

    def __init__(self, settings: SafetySettings) -> None:
        """Begin without samples."""
        self._timing, self._envelope, count = settings.timing, settings.envelope, settings.timing.speed_samples
        self._samples = {source: deque[tuple[float, float]](maxlen=count) for source in ("wheels", "receiver")}
        # the largest magnitude: when it was last asked for and known, s, and what it was, m/s
        self._known, self.last = (-math.inf, settings.envelope.speed), 0.0
        """newest, forward positive, m/s"""

    def add(self, time: float, source: str, speed: float) -> None:
        """Take in a speed, m/s, of `wheels` or `receiver` at a time, s; NaN is none."""
        if math.isfinite(speed):
            self._samples[source].append((time, speed))
            self.last = speed

    def fresh(self, time: float) -> dict[str, float]:
        """Return the newest magnitude of each source that has one which is not too old, m/s."""
        newest = {source: samples[-1] for source, samples in self._samples.items() if samples}
        return {source: abs(speed) for source, (at, speed) in newest.items() if time - at <= self._timing.speed}

    def known(self, time: float) -> bool:
        """Return whether there is a fresh speed, and no other that contradicts it.

        Means of the last three are compared, as an antenna sways on its mast; the newest counts three times.
        """
        newest = ([*self._samples[source]][-3:] + 2 * [self._samples[source][-1]] for source in self.fresh(time))
        means = [fmean(abs(speed) for at, speed in each if time - at <= self._timing.speed) for each in newest]
        return bool(means) and max(means) - min(means) <= self._timing.speed_difference

    def contradict(self, time: float) -> bool:
        """Return whether both sources are fresh, and differ on the average by more than slip: a wrong unit."""
        full = [each for each in self._samples.values() if len(each) == each.maxlen and time - each[0][0] <= _RECENT]
        slow, fast = sorted(abs(fmean(speed for _, speed in each)) for each in full) if len(full) == 2 else (0.0, 0.0)
        return len(self.fresh(time)) == 2 and fast > max(self._timing.speed_ratio * slow, slow + _SMALL)

    def largest(self, time: float) -> float:
        """Return the largest magnitude of the last samples, m/s.

        Where it is not known: what the vehicle can have reached since it last was, the machine's largest at most. Less
        than that is not safe, and more would take the steering out of a curve that it is in.
        """
        if self.known(time):
            self._known = (time, max(abs(speed) for source in self.fresh(time) for _, speed in self._samples[source]))
        since, speed = self._known
        return min(speed + self._envelope.acceleration * (time - since), max(speed, self._envelope.speed))

    def believable(self, time: float) -> float:
        """Return the larger newest magnitude, as far as it is no more than known or this machine's largest, m/s.

        It is sent to boards, which release above 25 km/h, and turn no wheel at standstill: a false report of a receiver
        or of the wheels must bring about neither. Where no source is fresh, the newest of both stays.
        """
        return min(max(self.fresh(time).values(), default=abs(self.last)), self.largest(time), self._envelope.speed)

    def stands(self, time: float, slowest: float) -> bool:
        """Return whether the vehicle is for certain no faster than a speed, m/s."""
        return self.known(time) and max(self.fresh(time).values()) <= slowest
