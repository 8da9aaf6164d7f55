"""Doubts: which sensors contradict the motion, and are not listened to until the vehicle has been let go of.

The gate stops the vehicle for a doubt. Meanwhile it is steered by what is left; the estimator itself would follow where
both antennas have jumped, and the control step would end its run, and with it all steering, for a wrong hitch angle.

A wrong angle of hitch or joint first bends the estimate: yaws and crab angles make up for most of it, and both bodies
are steered beside the line without a word. What they cannot make up for shows in both angles, a few degrees for long;
a hitch sensor that is reversed is seen sooner (reversal.py). What it has bent is computed again without (hindsight.py).
Which of the two is wrong does not show, so all that is told of the trailer is left out: the tractor keeps to the line
by its own antenna, and the joint is held where its sensor says that it is (driving/controller.py).
"""

import math
from collections import deque
from dataclasses import replace
from statistics import fmean

from drawbar.driving.reversal import Reversal
from drawbar.safety.sanity import SanitySettings
from drawbar.signals import FixStatus, Measurement, SolverStatus, StepRecord
from drawbar.vehicle.parameters import VehicleParameters

DOUBTED = 3
"""samples in a row that contradict"""
_MEMORY = 1.0
"""time over which differences of the trailer's angles are averaged, s"""
_DIFFERENCE, _USUAL = math.radians(2.8), 7.0
"""mean of both together that is a contradiction: rad, and times its lately usual one, as rough ground has more"""
_LATELY = 30.0
"""time over which that is averaged, up to the last mean but one, which a fault has not bent yet, s"""
_FIRST, _FIRST_TIME = math.radians(0.6), 5.0
"""what is usual before anything is known of the ground, and the time for which that counts: rad, s"""
_MOVES = 0.1
"""speed below which nothing is learned of the ground, m/s"""


class Doubts:
    """What the last samples said of the positions, of both antennas together, and of the trailer's angles."""

    def __init__(self, settings: SanitySettings, vehicle: VehicleParameters, sample_time: float) -> None:
        """Begin without a doubt; `sample_time` in s."""
        self._hitch_limit = settings.hitch
        self._reversal = Reversal(vehicle, sample_time)
        count = max(round(_MEMORY / sample_time), DOUBTED)
        self._differences = deque[tuple[float, float]](maxlen=count)
        self._means = deque[float](maxlen=count)  # of them, rad
        self._share = sample_time / _LATELY
        self._usual, self._known = _FIRST**2, _FIRST_TIME / sample_time  # mean square in rad², samples
        self._positions = self._trailer = 0

    @property
    def exist(self) -> bool:
        """Whether anything is doubted."""
        return self._positions >= DOUBTED or self.trailer

    @property
    def trailer(self) -> bool:
        """Whether what is told of the trailer is doubted."""
        return self._trailer >= DOUBTED

    def look(self, record: StepRecord, *, engaged: bool, drifts: bool = False) -> None:
        """Take in a step, and whether both antennas drift; what is doubted while engaged stays so."""
        hitch, joint = _differences(record)
        self._differences.append((hitch, joint))
        differ = self._differ(moves=abs(record.measurement.speed) >= _MOVES)
        differ |= self._reversal.look(record)
        if not (engaged and self.trailer):
            self._trailer = DOUBTED if differ else self._trailer + 1 if abs(hitch) > self._hitch_limit else 0
        if self.trailer:  # by them the estimator was led astray, and rejects right fixes
            self._positions = 0
        elif not (engaged and self._positions >= DOUBTED):
            self._positions = DOUBTED if drifts else self._positions + 1 if _both_rejected(record) else 0

    def without(self, measurement: Measurement) -> Measurement:
        """Return a measurement without what is doubted."""
        nan = math.nan
        if self._positions >= DOUBTED:
            measurement = replace(measurement, tractor_x=nan, tractor_y=nan, trailer_x=nan, trailer_y=nan)
        if self.trailer:
            measurement = replace(measurement, hitch_angle=nan, trailer_steering=nan, trailer_x=nan, trailer_y=nan)
        return measurement

    def _differ(self, *, moves: bool) -> bool:
        """Return whether both angles together have differed for long, by more than they do on this ground."""
        if len(self._differences) < (self._differences.maxlen or 0):
            return False
        apart = math.hypot(*map(fmean, zip(*self._differences, strict=True)))
        limit = max(_DIFFERENCE, _USUAL * math.sqrt(self._usual))
        if moves:
            self._means.append(min(apart, limit))
            if len(self._means) == self._means.maxlen:
                self._known += 1.0
                self._usual += max(self._share, 1.0 / self._known) * (self._means[0] ** 2 - self._usual)
        return apart > limit


def _differences(record: StepRecord) -> tuple[float, float]:
    """Return measured minus estimated angles of hitch and joint, rad; 0 where there is nothing to compare."""
    measured, estimate = record.measurement, record.estimate
    if estimate.status is not SolverStatus.SOLVED:
        return 0.0, 0.0
    hitch = measured.hitch_angle - estimate.hitch_angle
    joint = measured.trailer_steering - estimate.trailer_steering
    return hitch if math.isfinite(hitch) else 0.0, joint if math.isfinite(joint) else 0.0


def _both_rejected(record: StepRecord) -> bool:
    """Whether the estimator believes neither antenna."""
    fixes = (record.estimate.tractor_fix, record.estimate.trailer_fix)
    return all(fix is FixStatus.REJECTED for fix in fixes)
