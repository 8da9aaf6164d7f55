"""Position drift: positions that depart from the integral of the receivers' own velocities, or jump.

A receiver finds its velocity from the carrier's Doppler shift, which a wrongly fixed ambiguity or a drifting reference
does not touch. Over the last seconds the displacement between two positions is compared with the velocity's integral
(displacement_error.py), across the present direction of travel only: a velocity in a wrong unit is detected elsewhere.
Wheels that slip sideways do not matter, as they move positions and velocities alike. Both antennas must drift to the
same side; their mean, of less noise than either, then decides. Where only one of them has a fixed solution, it alone
does.

A slow drift is looked for over a longer time, of each antenna by itself: an estimate that follows one of them takes a
drift of a few centimetres a second for crab angles, although the other is right. Then the difference of both antennas
also departs from the chain of both bodies (antennas_apart.py), and a lower limit holds, also for the difference of
their cross-track errors: a lag that both receivers have shows in both.

A jump of half a metre from one epoch to the next does not move the estimate: it rejects it. But it shows that the
positions are wrong, whatever else contradicts the estimate.

Until a drift is detected the estimate follows it, yaws and crab angles included. From then on the velocities' integral
takes the place of the positions, from where the antennas were before (sensor_faults.py).
"""

import math
from dataclasses import replace

from drawbar.driving.fault_detection.antenna_drift import AntennaDrift, slow_ratio
from drawbar.messages import Fixes, ReceiverReport
from drawbar.nanoseconds import seconds
from drawbar.signals import FixQuality, Measurement

_JUMP_TIME = 1.0
"""for which a jump is reported, s"""
_EACH = 0.65
"""of the limit (antenna_drift.py), which the error of each of two antennas exceeds"""
_SINGLE = 1.4
"""times the limit, which the error of the only one that is known exceeds"""
_LONE, _APART = 1.5, 0.9
"""times that of the longer time, which the error of one alone exceeds; of one that is apart from the other, too"""
_FITS = 0.5
"""of the limit, below which positions fit the velocities"""
_CONTRADICTIONS = 2
"""epochs in a row that make a drift"""


class PositionDrift:
    """Drift and jumps of both antennas; where only one of two drifts fast, the estimator rejects it."""

    def __init__(self) -> None:
        """Begin without an epoch."""
        self._tractor, self._trailer = AntennaDrift(), AntennaDrift()
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
    def tractor_fits(self) -> bool:
        """Whether the tractor's positions have followed its velocities lately."""
        return abs(self._tractor.ratio) < _FITS and not self._is_recent(self._tractor.jumped)

    @property
    def is_detected(self) -> bool:
        """Whether both antennas drift, or the only one that is known."""
        return self._contradictions >= _CONTRADICTIONS

    def drifts_slowly(self, *, tractor: bool, trailer: bool, apart: float = 0.0) -> bool:
        """Return whether both antennas drift slowly, or one that the estimate accepts.

        The limit is lower where the estimate rejects the other, although that agrees with its velocities, and still
        lower where the antennas are apart.

        Args:
            tractor: it accepts the tractor's.
            trailer: it accepts the trailer's.
            apart: how far the tractor's is to the left of the trailer's, see antennas_apart.py.
        """
        one, other = self._tractor.slow_ratio, self._trailer.slow_ratio
        tractor_drifts = tractor and abs(one) > (_LONE if trailer or abs(other) > _EACH else 1.0)
        trailer_drifts = trailer and abs(other) > (_LONE if tractor or abs(one) > _EACH else 1.0)
        side = math.copysign(1.0, apart)
        apart_drifts = abs(apart) > 1.0 and self._one_drifts_to(side, tractor=tractor, trailer=trailer)
        return tractor_drifts or trailer_drifts or apart_drifts or _agree(one, other)

    def _one_drifts_to(self, side: float, *, tractor: bool, trailer: bool) -> bool:
        """Return whether an accepted antenna drifts to the side to which it is apart: 1, the tractor's to the left.

        A lag that both receivers may have explains an error of one, but not a difference of both.
        """
        one, other = self._tractor.slow_error, self._trailer.slow_error
        if one is None or other is None:
            return False
        lag = max(self._tractor.long_lag, self._trailer.long_lag)
        differ = side * slow_ratio(one.minus(other), lag) > 1.0
        sides = ((tractor, side, self._tractor, one), (trailer, -side, self._trailer, other))
        return any(
            accepted and own * slow_ratio(error, 0.0) > _APART and (differ or own * antenna.slow_ratio > _APART)
            for accepted, own, antenna, error in sides
        )

    def begin_dead_reckoning(self) -> None:
        """Go on from where both antennas were a moment before their drift was detected."""
        slowly = not self.is_detected
        self._tractor.begin_dead_reckoning(slowly=slowly)
        self._trailer.begin_dead_reckoning(slowly=slowly)

    def dead_reckoned(self, measurement: Measurement) -> Measurement:
        """Return a measurement with both positions by the velocities' integral from there; NaN after a lost epoch."""
        (x, y), (trailer_x, trailer_y) = self._tractor.dead_reckoned(), self._trailer.dead_reckoned()
        return replace(measurement, tractor_x=x, tractor_y=y, trailer_x=trailer_x, trailer_y=trailer_y)

    def receive_fixes(self, fixes: Fixes) -> None:
        """Add an epoch."""
        self._time = time = seconds(fixes.epoch)
        tractor = self._tractor.add(time, *_motion(fixes.tractor))
        trailer = self._trailer.add(time, *_motion(fixes.trailer))
        self._contradictions = self._contradictions + 1 if _contradict(tractor, trailer) else 0


def _contradict(tractor: float, trailer: float) -> bool:
    """Return whether cross-track errors, each over its limit, NaN: unknown, are a contradiction."""
    if math.isfinite(tractor + trailer):
        return _agree(tractor, trailer)
    return abs(tractor) > _SINGLE or abs(trailer) > _SINGLE


def _agree(tractor: float, trailer: float) -> bool:
    """Return whether both antennas contradict to the same side."""
    least, mean = min(abs(tractor), abs(trailer)), 0.5 * abs(tractor + trailer)
    return tractor * trailer > 0.0 and least > _EACH and mean > 1.0


def fixed_motion(report: ReceiverReport) -> tuple[float, float, tuple[float, float]]:
    """Return position (m) and velocity (m/s) of an antenna, NaN unless its ambiguities are fixed."""
    x, y, velocity = _motion(report)
    return (x, y, velocity) if math.isfinite(x) else (math.nan, math.nan, (math.nan, math.nan))


def _motion(report: ReceiverReport) -> tuple[float, float, tuple[float, float]]:
    """Return position (m) and velocity (m/s) of an antenna, the position NaN unless its ambiguities are fixed."""
    velocity = (report.speed * math.cos(report.course), report.speed * math.sin(report.course))
    return (report.x, report.y, velocity) if report.quality == FixQuality.FIXED else (math.nan, math.nan, velocity)
