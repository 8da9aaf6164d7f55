"""Screening of position fixes: what a receiver repeats, or cannot have seen, is masked before it is estimated with.

Each fix is compared with where the estimator expects that antenna, across and along the vehicle: a validation gate
(Bar-Shalom, Li, Kirubarajan 2001, section 5.4) that widens while there is no fix. What is too small for the gate shows
in how both antennas disagree (`suspicion.py`); what both agree on prevails in the end (`trust.py`).
"""

import math
from dataclasses import dataclass, replace

from drawbar.estimation.antennas import Antennas, Point, length_error, offsets, reported
from drawbar.estimation.noise_level import NoiseLevel
from drawbar.estimation.settings import ScreeningSettings
from drawbar.estimation.suspicion import Suspicion
from drawbar.estimation.trust import Trust
from drawbar.signals import Estimate, FixStatus, Measurement


@dataclass(frozen=True, slots=True, kw_only=True)
class Screened:
    """A measurement without the fixes that are not to be believed."""

    measurement: Measurement
    """NaN in place of what was masked"""
    fixes: tuple[FixStatus, FixStatus]
    """of the tractor's antenna and of the trailer's"""
    exposed: int | None
    """antenna (0, 1) that has become suspect with this sample: what it reported just before was wrong as well"""
    restart: bool
    """both antennas overrule the estimate: it is to start anew from this measurement"""

    def mark(self, estimate: Estimate) -> Estimate:
        """Return the estimate with what became of the fixes."""
        return replace(estimate, tractor_fix=self.fixes[0], trailer_fix=self.fixes[1])


class Screening:
    """Judges the fixes of both antennas sample by sample; its state is a few numbers."""

    def __init__(self, settings: ScreeningSettings, deviation: float) -> None:
        """Take the limits, and the standard deviation of one coordinate, m."""
        self._settings, self._least_deviation = settings, deviation
        self._noise = NoiseLevel(settings.long_memory)
        self._receivers = (_Receiver(), _Receiver())
        self._suspicion, self._trust = Suspicion(settings), Trust(settings.patience)
        self._length_error, self._lengths = 0.0, 0  # mean error of the antennas' distance, m; samples in it

    def screen(self, measurement: Measurement, expected: Antennas) -> Screened:
        """Mask what is not to be believed.

        Args:
            measurement: as the sensors report it.
            expected: where the estimator expects the antennas at the measurement's time.
        """
        time, fixes = measurement.time, reported(measurement)
        tractor, trailer = (self._fresh(*each) for each in zip(self._receivers, fixes, expected, strict=True))
        both = tractor is trailer is FixStatus.ACCEPTED
        before = self._suspicion.suspect
        outside = self._compare(time, fixes, expected, both)
        suspect = self._suspicion.suspect
        found = (_judged(tractor, outside[0] or suspect == 0), _judged(trailer, outside[1] or suspect == 1))
        error = length_error(fixes, expected)
        rejected = found.count(FixStatus.REJECTED)
        restart = self._trust.overruled(time, agreeing=both and self._plausible(error), rejected=rejected)
        if restart:
            self._suspicion.forget()
            found = (FixStatus.ACCEPTED, FixStatus.ACCEPTED)
        elif both and not rejected:
            self._learn(error)
        for receiver, status in zip(self._receivers, found, strict=True):
            receiver.accepted = time if status is FixStatus.ACCEPTED else receiver.accepted
        exposed = suspect if suspect != before and not restart else None
        return Screened(measurement=_masked(measurement, found), fixes=found, exposed=exposed, restart=restart)

    def _fresh(self, receiver: "_Receiver", fix: Point, expected: Point) -> FixStatus:
        if not math.isfinite(fix[0] + fix[1]):
            return FixStatus.MISSING
        stale = receiver.travelled(fix, expected) > self._settings.repetition
        return FixStatus.STALE if stale else FixStatus.ACCEPTED

    def _compare(self, time: float, fixes: Antennas, expected: Antennas, both: bool) -> tuple[bool, bool]:
        """Return which fixes lie outside their gates, and let both be compared with each other."""
        tractor, trailer = offsets(fixes, expected)
        rooms = self._rooms(time)
        deviation = max(self._noise.deviation, self._least_deviation)
        lateral = self._settings.lateral * deviation
        outside = self._outside(tractor, lateral, rooms[0]), self._outside(trailer, lateral, rooms[1])
        if both:
            half = 0.5 * self._length_error  # each is off by half of what the configured lengths are wrong
            tractor, trailer = (tractor[0] - half, tractor[1]), (trailer[0] + half, trailer[1])
            self._noise.update((tractor[0] - trailer[0], tractor[1] - trailer[1]), 2.0 * lateral)
        else:
            self._noise.interrupt()
        if both and self._trust.earned:
            self._suspicion.update((tractor, trailer), outside, deviation=deviation, room=max(rooms))
        else:  # an estimate that nobody has confirmed yet accuses no one
            self._suspicion.forget()
        return outside

    def _rooms(self, time: float) -> tuple[float, float]:
        """Return by how much each gate has widened for want of a fix, m."""
        limits = self._settings
        tractor, trailer = (
            time - receiver.accepted if math.isfinite(receiver.accepted) else 0.0 for receiver in self._receivers
        )
        common = limits.growth * min(tractor, trailer)
        return common + limits.single_growth * tractor, common + limits.single_growth * trailer

    def _outside(self, offset: Point, lateral: float, room: float) -> bool:
        ahead, left = offset
        return not (abs(left) <= lateral + room and abs(ahead) <= self._settings.longitudinal + room)

    def _plausible(self, error: float) -> bool:
        """Return whether the antennas are as far from each other as they have been, or at first as they should be."""
        limit = self._settings.length if self._lengths else self._settings.longitudinal
        return abs(error - self._length_error) <= limit

    def _learn(self, error: float) -> None:
        self._lengths = min(self._lengths + 1, self._settings.long_memory)
        self._length_error += (error - self._length_error) / self._lengths


class _Receiver:
    """What is remembered of one receiver."""

    def __init__(self) -> None:
        self._fix = self._expected = (math.nan, math.nan)
        self.accepted = math.nan
        """time of the last accepted fix, s"""

    def travelled(self, fix: Point, expected: Point) -> float:
        """Return how far the antenna has moved since the receiver first reported exactly this fix, m."""
        if fix != self._fix:
            self._fix, self._expected = fix, expected
        return math.dist(expected, self._expected)


def _judged(status: FixStatus, implausible: bool) -> FixStatus:
    return FixStatus.REJECTED if status is FixStatus.ACCEPTED and implausible else status


def _masked(measurement: Measurement, found: tuple[FixStatus, FixStatus]) -> Measurement:
    if found[0] is not FixStatus.ACCEPTED:
        measurement = replace(measurement, tractor_x=math.nan, tractor_y=math.nan)
    if found[1] is not FixStatus.ACCEPTED:
        measurement = replace(measurement, trailer_x=math.nan, trailer_y=math.nan)
    return measurement
