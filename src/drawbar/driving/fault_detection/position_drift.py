"""Position drift: positions that go aside of what the receivers' own velocities say, or jump.

A receiver finds its velocity from the carrier's Doppler shift, which a wrongly fixed ambiguity or a drifting reference
does not touch. Over the last seconds the way between two positions is held against the velocity's integral
(ways_aside.py), across the direction in which it goes now only: a velocity in a wrong unit is seen elsewhere. Wheels
that slip sideways do not matter, as both see that. Both antennas must go to the same side; their mean, of less noise
than either, then decides. Where only one of them has a fixed solution, it alone does.

A slow drift is seen over a longer time, of each antenna by itself: an estimate that follows one of them takes a drift
of a few centimetres a second for crab angles, although the other is right. Then both are apart of where the chain of
both bodies has them (antennas_apart.py), and less is enough, also what one goes aside more than the other: a lag that
both receivers have shows in both.

A jump beside the velocity by half a metre from one epoch to the next is none for the estimate to follow: it rejects
it. But it shows that the positions are wrong, whatever else contradicts the estimate.

Until a drift is seen the estimate follows it, yaws and crab angles included. From then on the velocities' integral
takes the place of the positions, from where the antennas were before (sensor_faults.py).
"""

import math
from collections import deque
from dataclasses import replace

from drawbar.driving.fault_detection.ways_aside import GAP, SAME, Aside, Lag, Odometer, Place, Window, mean_of
from drawbar.messages import Fixes, seconds
from drawbar.signals import FixQuality, Measurement

_WINDOW = 2.0
"""over which both ways are compared, s"""
_JUMP_TIME = 1.0
"""for which a jump is reported, s"""
_LONG = 8.0
"""over which a slow drift is looked for, s"""
_MEAN_TIME = 1.0
"""that its mean covers, s"""
_ASIDE, _SHARE = 0.15, 0.03
"""m, and of the way; both antennas' mean farther aside is a contradiction"""
_EACH = 0.65
"""of that, by which each of them is aside at least"""
_ALONE = 1.4
"""times that, by which the only one that is known is aside"""
_SLOWLY, _SLOW_SHARE = 0.20, 0.01
"""m, and of the way: the same over the longer time, in which noise counts less"""
_LONE, _APART = 1.5, 0.9
"""of that, by which one is aside alone; that is apart from the other, too"""
_AHEAD = 0.15
"""of the way, by which positions may be ahead of the velocities, or behind; more means speeds in a wrong unit"""
_LAG, _LATE_LAG = 0.15, 0.3
"""by which a receiver's filter lets the velocity's direction lag in a curve at most, s; over the longer time, in which
a lag counts more than noise"""
_MISSING = 3.0
"""longest without a fixed solution, after which it begins anew, s"""
_CONTRADICTIONS = 2
"""epochs in a row that make a drift"""


class _Antenna:
    """The last places of one antenna."""

    def __init__(self) -> None:
        self._window, self._long, self._odometer = Window(_WINDOW), Window(_LONG), Odometer()
        self._lag, self._late_lag = Lag(_WINDOW, _LAG), Lag(_LONG, _LATE_LAG)
        self._recent = deque[tuple[float, Aside]]()
        """times, s, and how far aside it was over the longer time"""
        self._right: Place | None = None
        self._before: Place | None = None
        """the last place before a jump that came with the newest epoch"""
        self._jumped = math.nan
        self.is_known = False
        """the newest epoch has its position"""

    @property
    def jumped(self) -> float:
        """Time of the last jump that has stayed, NaN: none, s."""
        return self._jumped if self._before is None else math.nan

    @property
    def late_lag(self) -> float:
        """The most by which the velocity's direction lags, s."""
        return self._late_lag.longest

    @property
    def recent(self) -> Aside | None:
        """How far it was aside over the longer time, mean of the last epochs; None where unknown."""
        if not self._recent or self._recent[-1][0] - self._recent[0][0] < _MEAN_TIME - SAME:
            return None
        return mean_of([aside for _, aside in self._recent])

    @property
    def slowly(self) -> float:
        """The same to the left, as `add` returns it."""
        return math.nan if (aside := self.recent) is None else _slow_share(aside, self.late_lag)

    def begin_dead_reckoning(self, *, slowly: bool) -> None:
        """Hold to the oldest place, of the longer time where it drifts slowly."""
        self._right = self._long.oldest if slowly else self._window.oldest

    def dead_reckoned(self) -> tuple[float, float]:
        """Return where the velocities have led from there, m; NaN where that is not known."""
        if self._right is None:
            return math.nan, math.nan
        way, before = self._odometer.way, self._right.way
        return self._right.x + way[0] - before[0], self._right.y + way[1] - before[1]

    def add(self, time: float, x: float, y: float, velocity: tuple[float, float]) -> float:
        """Take in an epoch; its place is NaN where it has no fixed solution.

        Returns:
            How far it is aside, to the left, as a share of what is a contradiction of both; NaN where not known.
        """
        goes_on = self._odometer.add(time, velocity)
        last, was_known = self._window.newest, self.is_known
        self.is_known = math.isfinite(x + y + sum(velocity))
        if not goes_on or (last is not None and time - last.time > _MISSING):
            self._begin_anew()
            last = None
        if not self.is_known:
            self._before = None
            self._recent.clear()
            return math.nan
        if last is not None and was_known and time - last.time <= GAP:
            self._follow(last, time, x, y)
        elif last is not None and not last.is_near(x, y, self._odometer.way):
            self._begin_anew()
        place = Place(time, x, y, velocity, self._odometer.way, self._odometer.doubt)
        self._window.add(place)
        self._long.add(place)
        aside = self._window.aside(self._window.way)
        if aside is None:
            self._recent.clear()
            return math.nan
        self._look_long(time, fits=abs(aside.ahead) <= max(_SLOWLY, _AHEAD * aside.way))
        return self._look(time, aside)

    def _begin_anew(self) -> None:
        self._window.clear()
        self._long.clear()
        self._recent.clear()
        self._right = None

    def _follow(self, last: Place, time: float, x: float, y: float) -> None:
        """Take in the place of the next epoch: one to which the last one does not lead is a jump.

        None that goes back after a single epoch has jumped.
        """
        if last.leads_to(time, x, y):
            self._before = None
            return
        self._begin_anew()
        goes_back = self._before is not None and self._before.leads_to(time, x, y)
        self._before, self._jumped = (None, math.nan) if goes_back else (last, time)

    def _look(self, time: float, aside: Aside) -> float:
        share = aside.share_of(_ASIDE, _SHARE, self._lag.longest)
        for lag in (self._lag, self._late_lag):
            lag.add(time, aside.left, aside.per_lag)
        return share

    def _look_long(self, time: float, *, fits: bool) -> None:
        """Look at the longer time, if the speeds fit the way of the shorter one."""
        aside = self._long.aside(self._window.way)
        if aside is None or not fits:
            self._recent.clear()
            return
        self._recent.append((time, aside))
        while time - self._recent[0][0] > _MEAN_TIME + SAME:
            self._recent.popleft()


class PositionDrift:
    """What the last epochs say of both antennas; of two, one that goes astray alone is the estimator's to reject."""

    def __init__(self) -> None:
        """Begin without an epoch."""
        self._tractor, self._trailer = _Antenna(), _Antenna()
        self._contradictions, self._time = 0, 0.0

    @property
    def has_jumped(self) -> bool:
        """Whether both antennas have just jumped together, or the only one that is known, and stayed there."""
        tractor, trailer = self._tractor, self._trailer
        if tractor.is_known and trailer.is_known:
            return tractor.jumped == trailer.jumped and self._is_recent(tractor.jumped)
        return any(each.is_known and self._is_recent(each.jumped) for each in (tractor, trailer))

    def _is_recent(self, jumped: float) -> bool:
        return self._time - jumped <= _JUMP_TIME

    @property
    def exists(self) -> bool:
        """Whether both antennas go aside, or the only one that is known."""
        return self._contradictions >= _CONTRADICTIONS

    def drifts_slowly(self, *, tractor: bool, trailer: bool, apart: float = 0.0) -> bool:
        """Return whether both antennas go aside slowly, or one that the estimate accepts.

        Where it rejects the other, although that agrees with its velocities, less is enough; still less where the
        antennas are apart.

        Args:
            tractor: it accepts the tractor's.
            trailer: it accepts the trailer's.
            apart: how far the tractor's is to the left of the trailer's, see antennas_apart.py.
        """
        one, other = self._tractor.slowly, self._trailer.slowly
        tractor_strays = tractor and abs(one) > (_LONE if trailer or abs(other) > _EACH else 1.0)
        trailer_strays = trailer and abs(other) > (_LONE if tractor or abs(one) > _EACH else 1.0)
        apart_strays = abs(apart) > 1.0 and self._strays(math.copysign(1.0, apart), tractor=tractor, trailer=trailer)
        return tractor_strays or trailer_strays or apart_strays or _agree(one, other)

    def _strays(self, side: float, *, tractor: bool, trailer: bool) -> bool:
        """Return whether an accepted antenna is aside to the side to which it is apart: 1, the tractor's to the left.

        A lag explains it where both may have it, not where one is farther aside than the other.
        """
        one, other = self._tractor.recent, self._trailer.recent
        if one is None or other is None:
            return False
        lag = max(self._tractor.late_lag, self._trailer.late_lag)
        differ = side * _slow_share(one.beyond(other), lag) > 1.0
        sides = ((tractor, side, self._tractor, one), (trailer, -side, self._trailer, other))
        return any(
            accepted and own * _slow_share(aside, 0.0) > _APART and (differ or own * antenna.slowly > _APART)
            for accepted, own, antenna, aside in sides
        )

    def begin_dead_reckoning(self) -> None:
        """Hold to where both antennas were a moment before they were seen to drift."""
        slowly = not self.exists
        self._tractor.begin_dead_reckoning(slowly=slowly)
        self._trailer.begin_dead_reckoning(slowly=slowly)

    def dead_reckoned(self, measurement: Measurement) -> Measurement:
        """Return a measurement with both antennas where the velocities have led from there; NaN after a lost epoch."""
        (x, y), (trailer_x, trailer_y) = self._tractor.dead_reckoned(), self._trailer.dead_reckoned()
        return replace(measurement, tractor_x=x, tractor_y=y, trailer_x=trailer_x, trailer_y=trailer_y)

    def receive_fixes(self, fixes: Fixes) -> None:
        """Take in an epoch."""
        self._time = time = seconds(fixes.epoch)
        tractor = self._tractor.add(time, *_motion(fixes, "tractor"))
        trailer = self._trailer.add(time, *_motion(fixes, "trailer"))
        self._contradictions = self._contradictions + 1 if _contradict(tractor, trailer) else 0


def _slow_share(aside: Aside, lag: float) -> float:
    """Return how far it is aside over the longer time, as a share of what is a contradiction of both."""
    return aside.share_of(_SLOWLY, _SLOW_SHARE, lag)


def _contradict(tractor: float, trailer: float) -> bool:
    """Return whether what is known of how far both antennas are aside is a contradiction."""
    if math.isfinite(tractor + trailer):
        return _agree(tractor, trailer)
    return abs(tractor) > _ALONE or abs(trailer) > _ALONE


def _agree(tractor: float, trailer: float) -> bool:
    """Return whether both antennas contradict to the same side."""
    least, mean = min(abs(tractor), abs(trailer)), 0.5 * abs(tractor + trailer)
    return tractor * trailer > 0.0 and least > _EACH and mean > 1.0


def fixed_motion(fixes: Fixes, body: str) -> tuple[float, float, tuple[float, float]]:
    """Return place (m) and velocity (m/s) of an antenna, NaN unless its ambiguities are fixed."""
    x, y, velocity = _motion(fixes, body)
    return (x, y, velocity) if math.isfinite(x) else (math.nan, math.nan, (math.nan, math.nan))


def _motion(fixes: Fixes, body: str) -> tuple[float, float, tuple[float, float]]:
    """Return place (m) and velocity (m/s) of an antenna, the place NaN unless its ambiguities are fixed."""
    speed, course = getattr(fixes, f"{body}_speed"), getattr(fixes, f"{body}_course")
    velocity = (speed * math.cos(course), speed * math.sin(course))
    if getattr(fixes, f"{body}_quality") != FixQuality.FIXED:
        return math.nan, math.nan, velocity
    return getattr(fixes, f"{body}_x"), getattr(fixes, f"{body}_y"), velocity
