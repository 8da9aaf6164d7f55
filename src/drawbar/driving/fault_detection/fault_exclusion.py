"""Fault exclusion: which sensors contradict the motion, and are left out until the steering has been released.

The gate stops the vehicle for one. Meanwhile it is steered by what is left; the estimator itself would follow where
both antennas have jumped, and the control step would end its run, and with it all steering, for a wrong hitch angle.

A wrong angle of hitch or joint first bends the estimate: yaws and crab angles make up for most of it, and both bodies
are steered beside the line without a word. What they cannot make up for shows in both angles, a few degrees for long,
and fewer count where an antenna is contradicted as well; a hitch sensor that is reversed (reversed_hitch_sensor.py) is
seen sooner, and so is one that reports the very same angle while the estimate turns. The control step goes by the same
signs (safety/hitch_watch.h), but waits longer: it can only end the run.
What they have bent is computed again without them (rollback.py).
Which of the two is wrong does not show, so all that is told of the trailer is left out: the tractor keeps to the line
by its own antenna, and the joint is held where its sensor says that it is (driving/loop/controller.py).
"""

import math
from collections import deque
from dataclasses import replace
from statistics import fmean

from drawbar.driving.fault_detection.reversed_hitch_sensor import ReversedHitchSensor
from drawbar.driving.fault_detection.running_rms import RunningRms
from drawbar.geometry import wrap
from drawbar.safety.sanity import SanitySettings
from drawbar.signals import FixStatus, Measurement, Pose, SolverStatus, StepRecord
from drawbar.vehicle.parameters import VehicleParameters

CONFIRMED = 3
"""samples in a row whose contradiction excludes a sensor"""
_MEMORY = 1.0
"""time over which differences of the trailer's angles are averaged, s"""
_DIFFERENCE, _USUAL = math.radians(2.8), 7.0
"""mean of both together that is a contradiction: rad, and times its lately usual one, as rough ground has more"""
_SHARP = 3.0
"""times that limit that one difference counts in the mean at most, so that a single false angle is none"""
_FIRST, _FIRST_TIME = math.radians(0.6), 5.0
"""what is usual before anything is known of the ground, and the time for which that counts: rad, s"""
_SPAN = 0.6
"""time over which an antenna's distance from its estimate is averaged, s"""
_ASIDE, _LEAST = 3.0, 0.04
"""times its usual one, at least so much (m), from which on the antenna is contradicted"""
_SHARE = 0.65
"""of the limit above, where an antenna is contradicted as well"""
_MOVES = 0.1
"""speed below which nothing is learned of the ground, m/s"""
_TURNED = 0.5
"""share of the limit of a single hitch angle by which the estimate turns while a stuck sensor does not"""
_SHIFTED = math.radians(0.7)
"""by which it turns while a sensor stands still that hardly ever repeats itself, beside its resolution, rad"""
_FINE, _MORE, _KNOWN = 4, 4, 50
"""of such a one: repetitions in a row at most, how many more than twice that it never has, samples until it is known"""


class _AntennaResidual:
    """How far one antenna is from where it is estimated."""

    def __init__(self, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._distances = deque[float](maxlen=max(round(_SPAN / sample_time), 1))  # m
        self._rms = RunningRms(sample_time)

    def contradicts(self, x: float, y: float, place: Pose, *, moves: bool) -> bool:
        """Take in where it is (m), NaN where that is not known; return whether it is farther than it usually is."""
        distance = math.hypot(x - place.x, y - place.y)
        if not math.isfinite(distance):
            return False
        self._distances.append(distance)
        mean = fmean(self._distances)
        if moves:
            self._rms.add(mean)
        full = len(self._distances) == self._distances.maxlen
        return full and mean > _ASIDE * max(self._rms.value, _LEAST)


class _StuckHitchSensor:
    """Whether the hitch sensor reports the very same angle although the estimate turns.

    As estimation/frozen_signal.h, which the control step goes by, a sample sooner.
    """

    def __init__(self, limit: float) -> None:
        """Begin without a sample; `limit` of the estimate's turn in rad."""
        self._limit, self._still, self._finest = limit, math.nan, math.inf
        self._least = self._most = math.nan
        self._repeated = self._longest = self._known = self._samples = 0

    def update(self, measured: float, estimated: float, *, moves: bool) -> bool:
        """Take in both angles, rad; return whether it is stuck."""
        self._known += moves
        if measured == self._still:
            self._repeated += moves
        else:  # also when it is missing
            if (change := abs(measured - self._still)) < self._finest:
                self._finest = change
            self._longest = max(self._longest, self._repeated)
            self._still, self._least, self._most, self._repeated = measured, estimated, estimated, 0
        self._least, self._most = min(self._least, estimated), max(self._most, estimated)
        turned, away = self._most - self._least, abs(wrap(estimated - measured))
        self._samples = self._samples + 1 if turned > self._limit and away > 0.5 * self._limit else 0
        return self._samples >= CONFIRMED or (self._is_unusual and turned > _SHIFTED + min(self._finest, _SHIFTED))

    @property
    def _is_unusual(self) -> bool:
        """Whether a fine sensor has repeated itself as it never does."""
        fine = self._known >= _KNOWN and self._longest <= _FINE
        return fine and self._repeated >= 2 * self._longest + _MORE


class FaultExclusion:
    """What the last samples said of the positions, of both antennas together, and of the trailer's angles."""

    def __init__(self, settings: SanitySettings, vehicle: VehicleParameters, sample_time: float) -> None:
        """Begin with nothing excluded; `sample_time` in s."""
        self._hitch_limit = settings.hitch
        self._reversed = ReversedHitchSensor(vehicle, sample_time)
        self._stuck = _StuckHitchSensor(_TURNED * settings.hitch)
        count = max(round(_MEMORY / sample_time), CONFIRMED)
        self._differences = deque[tuple[float, float]](maxlen=count)
        self._rms = RunningRms(sample_time, first=_FIRST, first_time=_FIRST_TIME)  # mean of them, rad
        self._tractor_antenna, self._trailer_antenna = _AntennaResidual(sample_time), _AntennaResidual(sample_time)
        self._positions = self._trailer = 0
        self._certain = False
        """the receivers themselves contradict the positions"""

    @property
    def is_active(self) -> bool:
        """Whether anything is excluded."""
        return self.excludes_positions or self.excludes_trailer

    @property
    def excludes_positions(self) -> bool:
        """Whether positions are excluded."""
        return self._positions >= CONFIRMED

    @property
    def excludes_trailer(self) -> bool:
        """Whether what is told of the trailer is excluded."""
        return self._trailer >= CONFIRMED

    def update(self, record: StepRecord, *, engaged: bool, moved: bool = False) -> None:
        """Take in a step, and whether positions drift or have jumped; what is excluded while engaged stays so."""
        hitch, joint = _differences(record)
        self._differences.append((hitch, joint))
        moves = abs(record.measurement.speed) >= _MOVES
        limit = _SHARE if self._aside(record, moves=moves) else 1.0
        differ = self._apart(moves=moves) > limit
        differ |= self._reversed.update(record)
        differ |= self._stuck.update(record.measurement.hitch_angle, record.estimate.hitch_angle, moves=moves)
        if not (engaged and self.excludes_trailer):
            self._trailer = CONFIRMED if differ else self._trailer + 1 if abs(hitch) > self._hitch_limit else 0
        self._certain = moved or (engaged and self._certain)
        if self._certain:
            self._positions = CONFIRMED
        elif self.excludes_trailer:  # by them the estimator was led astray, and rejects right fixes
            self._positions = 0
        elif not (engaged and self.excludes_positions):
            self._positions = self._positions + 1 if _both_rejected(record) else 0

    def without_excluded(self, measurement: Measurement) -> Measurement:
        """Return a measurement without what is excluded."""
        nan = math.nan
        if self.excludes_positions:
            measurement = replace(measurement, tractor_x=nan, tractor_y=nan, trailer_x=nan, trailer_y=nan)
        return self.without_trailer(measurement)

    def without_trailer(self, measurement: Measurement) -> Measurement:
        """Return a measurement without what is told of the trailer, where that is excluded."""
        if not self.excludes_trailer:
            return measurement
        nan = math.nan
        return replace(measurement, hitch_angle=nan, trailer_steering=nan, trailer_x=nan, trailer_y=nan)

    def _apart(self, *, moves: bool) -> float:
        """Return by how much both angles together have differed for long, as a share of what is a contradiction."""
        if len(self._differences) < (self._differences.maxlen or 0):
            return 0.0
        limit = max(_DIFFERENCE, _USUAL * self._rms.value)
        counted = (
            (_clipped(hitch, _SHARP * limit), _clipped(joint, _SHARP * limit)) for hitch, joint in self._differences
        )
        apart = math.hypot(*map(fmean, zip(*counted, strict=True)))
        if moves:
            self._rms.add(min(apart, limit))
        return apart / limit

    def _aside(self, record: StepRecord, *, moves: bool) -> bool:
        """Return whether an antenna is farther from its estimate than it usually is."""
        m, found = record.measurement, record.estimate
        tractor = self._tractor_antenna.contradicts(m.tractor_x, m.tractor_y, found.tractor, moves=moves)
        trailer = self._trailer_antenna.contradicts(m.trailer_x, m.trailer_y, found.trailer, moves=moves)
        return tractor or trailer


def _differences(record: StepRecord) -> tuple[float, float]:
    """Return measured minus estimated angles of hitch and joint, rad; 0 where there is nothing to compare."""
    measured, estimate = record.measurement, record.estimate
    if estimate.status is not SolverStatus.SOLVED:
        return 0.0, 0.0
    hitch = measured.hitch_angle - estimate.hitch_angle
    joint = measured.trailer_steering - estimate.trailer_steering
    return hitch if math.isfinite(hitch) else 0.0, joint if math.isfinite(joint) else 0.0


def _clipped(angle: float, limit: float) -> float:
    return min(max(angle, -limit), limit)


def _both_rejected(record: StepRecord) -> bool:
    """Whether the estimator believes neither antenna."""
    fixes = (record.estimate.tractor_fix, record.estimate.trailer_fix)
    return all(fix is FixStatus.REJECTED for fix in fixes)
