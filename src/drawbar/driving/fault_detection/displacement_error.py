"""Displacement error: how far an antenna's positions depart from the integral of its receiver's velocity.

The displacement between two positions is compared with the velocity's integral between them. In a curve the direction
of the velocity lags, and the error points to the inside. How much it lags is estimated for each receiver.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

JUMP = 0.5
"""m between a position and where the velocity leads from the epoch before: farther is a jump, no drift"""
GAP, BRIDGED = 0.5, 1.3
"""between two velocities, s: after the first their integral is uncertain, after the second it begins anew"""
_TRAPEZOID_ERROR = 0.02
"""of the integral between two velocities, m for each m²/s² and s³: the front wheels turning at 20°/s all the while"""
_LEAST_SPEED = 0.25
"""mean speed from which a displacement has a direction, m/s"""
_PRIOR_WEIGHT = 2.0
"""of the largest lag, beside what curves show, m²/s²"""
SAME = 1e-6
"""times nearer than this are the same, s"""


@dataclass(frozen=True, slots=True)
class PositionSample:
    """One position of an antenna, with velocity and the velocity's integral."""

    time: float
    """s"""
    x: float
    """m"""
    y: float
    """m"""
    velocity: tuple[float, float]
    """east and north, m/s"""
    integral: tuple[float, float]
    """of the velocity, east and north, m"""
    uncertainty: float = 0.0
    """of the integral, by lost epochs, m"""

    def leads_to(self, time: float, x: float, y: float) -> bool:
        """Return whether a position can be the next one, without a gap or a jump."""
        step = time - self.time
        predicted = (self.x + step * self.velocity[0], self.y + step * self.velocity[1])
        return 0.0 < step <= GAP and math.dist((x, y), predicted) <= JUMP

    def is_near(self, x: float, y: float, integral: tuple[float, float]) -> bool:
        """Return whether the velocity's integral up to now leads near a position, without a jump."""
        predicted = (self.x + integral[0] - self.integral[0], self.y + integral[1] - self.integral[1])
        return math.dist((x, y), predicted) <= JUMP


class VelocityIntegral:
    """Integral of a receiver's velocities; over lost epochs it becomes uncertain, over many it begins anew."""

    def __init__(self) -> None:
        """Begin at zero."""
        self.value = (0.0, 0.0)
        """east and north, m"""
        self.uncertainty = 0.0
        """by lost epochs, m"""
        self._time, self._velocity = math.nan, (0.0, 0.0)

    def add(self, time: float, velocity: tuple[float, float]) -> bool:
        """Add a velocity, m/s, NaN: unknown; return whether the integral continues from before."""
        if not math.isfinite(sum(velocity)):
            return time - self._time <= BRIDGED
        step, before = time - self._time, self._velocity
        self._time, self._velocity = time, velocity
        if not 0.0 < step <= BRIDGED:
            return False
        east, north = self.value
        self.value = (east + 0.5 * step * (before[0] + velocity[0]), north + 0.5 * step * (before[1] + velocity[1]))
        if step > GAP:
            self.uncertainty += _TRAPEZOID_ERROR * max(math.hypot(*before), math.hypot(*velocity)) ** 2 * step**3
        return True


class CourseLag:
    """Lag of the direction of a receiver's velocity, estimated in curves."""

    def __init__(self, delay: float, largest: float) -> None:
        """Begin with the largest lag; an error is used `delay` after it was added; both in s."""
        self._delay, self._largest = delay, largest
        self._newest = deque[tuple[float, float, float]]()
        self._information = self._product = 0.0

    @property
    def largest(self) -> float:
        """Largest lag by what is known, s."""
        estimate = (self._product + _PRIOR_WEIGHT * self._largest) / (self._information + _PRIOR_WEIGHT)
        return min(max(estimate, 0.0), self._largest)

    def add(self, time: float, cross_track: float, lag_sensitivity: float) -> None:
        """Add a cross-track error, m, and its derivative by the lag, m/s; it is used once it is old.

        Used at once, a drift would count as a lag before it is detected.
        """
        self._newest.append((time, cross_track, lag_sensitivity))
        while time - self._newest[0][0] >= self._delay:
            _, before, by = self._newest.popleft()
            self._information += by**2
            self._product += before * by


@dataclass(frozen=True, slots=True)
class DisplacementError:
    """Displacement by positions minus displacement by velocities, over a time."""

    cross_track: float
    """left of the present direction of travel, m"""
    distance: float
    """travelled, m"""
    along_track: float
    """m"""
    lag_sensitivity: float
    """derivative of `cross_track` by the lag of the velocity's direction, m/s"""
    uncertainty: float
    """by lost epochs, m"""

    def ratio(self, least: float, share: float, lag: float) -> float:
        """Return the cross-track error over what a lag (s) and other errors, m and of the distance, explain."""
        inside = self.cross_track * self.lag_sensitivity > 0.0
        explained = share * self.distance + inside * lag * abs(self.lag_sensitivity)
        return self.cross_track / (max(least, explained) + self.uncertainty)

    def minus(self, other: "DisplacementError") -> "DisplacementError":
        """Return the difference from another antenna's, in which a lag of both receivers cancels."""
        return DisplacementError(
            cross_track=self.cross_track - other.cross_track,
            distance=max(self.distance, other.distance),
            along_track=self.along_track - other.along_track,
            lag_sensitivity=self.lag_sensitivity - other.lag_sensitivity,
            uncertainty=self.uncertainty + other.uncertainty,
        )


def mean_of(errors: Sequence[DisplacementError]) -> DisplacementError:
    """Return the mean of several, field by field."""
    return DisplacementError(*(fmean(getattr(each, name) for each in errors) for name in DisplacementError.__slots__))


class PositionWindow:
    """The positions of the last seconds."""

    def __init__(self, span: float) -> None:
        """Begin without a position; `span` in s."""
        self._span = span
        self._samples = deque[PositionSample]()

    @property
    def oldest(self) -> PositionSample | None:
        """The first sample, None where there is none."""
        return self._samples[0] if self._samples else None

    @property
    def newest(self) -> PositionSample | None:
        """The last sample, None where there is none."""
        return self._samples[-1] if self._samples else None

    def clear(self) -> None:
        """Remove all samples."""
        self._samples.clear()

    def add(self, sample: PositionSample) -> None:
        """Add a sample, and remove those that the span no longer covers."""
        self._samples.append(sample)
        while len(self._samples) > 1 and sample.time - self._samples[1].time >= self._span - SAME:
            self._samples.popleft()

    @property
    def integral(self) -> tuple[float, float]:
        """Integral of the velocity from the oldest sample to the newest, east and north, m."""
        first, last = self._samples[0], self._samples[-1]
        return last.integral[0] - first.integral[0], last.integral[1] - first.integral[1]

    def error(self, direction: tuple[float, float]) -> DisplacementError | None:
        """Return the displacement error from the oldest sample to the newest; None where it is not known.

        direction: of travel at present, a vector of any length.
        """
        first, last = self._samples[0], self._samples[-1]
        east, north = self.integral
        distance, length = math.hypot(east, north), math.hypot(*direction)
        if last.time - first.time < self._span - SAME or distance < _LEAST_SPEED * self._span or not length:
            return None
        x, y = direction[0] / length, direction[1] / length
        off_x, off_y = last.x - first.x - east, last.y - first.y - north
        turned = (last.velocity[0] - first.velocity[0], last.velocity[1] - first.velocity[1])
        return DisplacementError(
            cross_track=x * off_y - y * off_x,
            distance=distance,
            along_track=x * off_x + y * off_y,
            lag_sensitivity=x * turned[1] - y * turned[0],
            uncertainty=last.uncertainty - first.uncertainty,
        )
