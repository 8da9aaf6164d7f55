"""Ways aside: how far an antenna's positions go aside of what its receiver's velocities say.

The way between two positions is held against the velocity's integral between them. In a curve the direction of the
velocity lags, and the positions go aside of it, to the inside. By how much is learned of each receiver.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

JUMP = 0.5
"""m beside where the velocity leads from one epoch to the next: farther is a jump, no drift"""
GAP, BRIDGED = 0.5, 1.3
"""between two velocities, s: after the first the way between them is in doubt, after the second it begins anew"""
_SWERVE = 0.02
"""by which the way between two velocities may be beside their mean, m for each m²/s² and s³: where the front wheels
turn at 20°/s all the while"""
_LEAST = 0.25
"""mean speed whose way has a direction, m/s"""
_DOUBT = 2.0
"""weight of the most that a lag may be against what curves say of it, m²/s²"""
SAME = 1e-6
"""times nearer than this are the same, s"""


@dataclass(frozen=True, slots=True)
class Place:
    """What a receiver has said once."""

    time: float
    """s"""
    x: float
    """m"""
    y: float
    """m"""
    velocity: tuple[float, float]
    """east and north, m/s"""
    way: tuple[float, float]
    """integral of the velocity, east and north, m"""
    doubt: float = 0.0
    """by which that may be wrong, as epochs were lost, m"""

    def leads_to(self, time: float, x: float, y: float) -> bool:
        """Return whether another place can be a next one, without a gap or a jump."""
        step = time - self.time
        led = (self.x + step * self.velocity[0], self.y + step * self.velocity[1])
        return 0.0 < step <= GAP and math.dist((x, y), led) <= JUMP

    def is_near(self, x: float, y: float, way: tuple[float, float]) -> bool:
        """Return whether the way until now leads near another place, without a jump."""
        led = (self.x + way[0] - self.way[0], self.y + way[1] - self.way[1])
        return math.dist((x, y), led) <= JUMP


class Odometer:
    """Integral of a receiver's velocities; over lost epochs it is in doubt, over many it begins anew."""

    def __init__(self) -> None:
        """Begin at zero."""
        self.way = (0.0, 0.0)
        """east and north, m"""
        self.doubt = 0.0
        """by which it may be wrong, as epochs were lost, m"""
        self._time, self._velocity = math.nan, (0.0, 0.0)

    def add(self, time: float, velocity: tuple[float, float]) -> bool:
        """Take in a velocity, m/s, NaN: unknown; return whether the way goes on from before."""
        if not math.isfinite(sum(velocity)):
            return time - self._time <= BRIDGED
        step, before = time - self._time, self._velocity
        self._time, self._velocity = time, velocity
        if not 0.0 < step <= BRIDGED:
            return False
        east, north = self.way
        self.way = (east + 0.5 * step * (before[0] + velocity[0]), north + 0.5 * step * (before[1] + velocity[1]))
        if step > GAP:
            self.doubt += _SWERVE * max(math.hypot(*before), math.hypot(*velocity)) ** 2 * step**3
        return True


class Lag:
    """By how much the direction of a receiver's velocity lags, learned where it turns."""

    def __init__(self, delay: float, most: float) -> None:
        """Begin with the most that it may be; what is seen is learned from after `delay`; both in s."""
        self._delay, self._most = delay, most
        self._newest = deque[tuple[float, float, float]]()
        self._known = self._product = 0.0

    @property
    def longest(self) -> float:
        """The most that it may be by what is known, s."""
        return min(max((self._product + _DOUBT * self._most) / (self._known + _DOUBT), 0.0), self._most)

    def add(self, time: float, aside: float, per_lag: float) -> None:
        """Take in a distance aside, m, and its derivative by the lag, m/s; it is learned from once it is old.

        A drift would teach a lag before it is seen.
        """
        self._newest.append((time, aside, per_lag))
        while time - self._newest[0][0] >= self._delay:
            _, before, by = self._newest.popleft()
            self._known += by**2
            self._product += before * by


@dataclass(frozen=True, slots=True)
class Aside:
    """How far positions are aside of the velocities, over a time."""

    left: float
    """across the direction in which it goes now, m"""
    way: float
    """m"""
    ahead: float
    """m"""
    per_lag: float
    """by how much more it is to the left for each second by which the velocity's direction lags, m/s"""
    doubt: float
    """by which it may be wrong, as epochs were lost, m"""

    def share_of(self, least: float, share: float, lag: float) -> float:
        """Return it as a share of the most that a lag (s) and other errors, m and of the way, explain."""
        inside = self.left * self.per_lag > 0.0
        return self.left / (max(least, share * self.way + inside * lag * abs(self.per_lag)) + self.doubt)

    def beyond(self, other: "Aside") -> "Aside":
        """Return how much farther aside it is than another, without what a lag of both does to both."""
        way, ahead, doubt = max(self.way, other.way), self.ahead - other.ahead, self.doubt + other.doubt
        return Aside(self.left - other.left, way, ahead, self.per_lag - other.per_lag, doubt)


def mean_of(asides: Sequence[Aside]) -> Aside:
    """Return what several are on average."""
    return Aside(*(fmean(getattr(each, name) for each in asides) for name in Aside.__slots__))


class Window:
    """The places of the last seconds."""

    def __init__(self, span: float) -> None:
        """Begin without a place; `span` in s."""
        self._span = span
        self._places = deque[Place]()

    @property
    def oldest(self) -> Place | None:
        """The first place, None where there is none."""
        return self._places[0] if self._places else None

    @property
    def newest(self) -> Place | None:
        """The last place, None where there is none."""
        return self._places[-1] if self._places else None

    def clear(self) -> None:
        """Forget all places."""
        self._places.clear()

    def add(self, place: Place) -> None:
        """Take in a place."""
        self._places.append(place)
        while len(self._places) > 1 and place.time - self._places[1].time >= self._span - SAME:
            self._places.popleft()

    @property
    def way(self) -> tuple[float, float]:
        """Integral of the velocity from the oldest place to the newest, east and north, m."""
        first, last = self._places[0], self._places[-1]
        return last.way[0] - first.way[0], last.way[1] - first.way[1]

    def aside(self, direction: tuple[float, float]) -> Aside | None:
        """Return how far the newest is aside, as seen from the oldest; None where that is not known.

        direction: in which it goes now, a vector of any length.
        """
        first, last = self._places[0], self._places[-1]
        east, north = self.way
        way, length = math.hypot(east, north), math.hypot(*direction)
        if last.time - first.time < self._span - SAME or way < _LEAST * self._span or not length:
            return None
        x, y = direction[0] / length, direction[1] / length
        off_x, off_y = last.x - first.x - east, last.y - first.y - north
        turned = (last.velocity[0] - first.velocity[0], last.velocity[1] - first.velocity[1])
        return Aside(
            left=x * off_y - y * off_x,
            way=way,
            ahead=x * off_x + y * off_y,
            per_lag=x * turned[1] - y * turned[0],
            doubt=last.doubt - first.doubt,
        )
