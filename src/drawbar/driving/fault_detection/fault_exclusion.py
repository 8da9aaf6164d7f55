"""Fault exclusion: which sensors contradict the motion, and are left out until the steering has been released.

The gate stops the vehicle for one. Meanwhile it is steered by what is left; the estimator itself would follow where
both antennas have jumped, and the control step would end its run, and with it all steering, for a wrong hitch angle.

The estimate first absorbs most of a wrong angle of hitch or joint in yaws and crab angles, and both bodies are steered
beside the line. A residual of a few degrees remains in both angles, and a smaller one counts where an antenna is
contradicted as well; a hitch sensor that is reversed (reversed_hitch_sensor.py) or repeats one angle while the estimate
turns (stuck_hitch_sensor.py) is detected earlier, and one that drifts by what wheels and joint lead to
(contradicting_angles.py) and by what all see together (contradiction.py). The control step tests the same residuals
(safety/hitch_watch.h), but waits longer: it can only end the run. The numbers of both are held together by
tests/test_shared_numbers.py.
The corrupted samples are computed again without the sensor (rollback.py). Which of the two angles is wrong is not
observable, so all measurements of the trailer are left out: the tractor keeps to the line by its own antenna, and the
joint is held at its measured angle (driving/loop/controller.py).
"""

import math
from dataclasses import replace
from statistics import fmean

from drawbar.driving.fault_detection.confirmation import CONFIRMED
from drawbar.driving.fault_detection.contradicting_angles import ContradictingAngles
from drawbar.driving.fault_detection.contradiction import Contradiction, Shares, contradiction
from drawbar.driving.fault_detection.recent import Recent
from drawbar.driving.fault_detection.reversed_hitch_sensor import ReversedHitchSensor
from drawbar.driving.fault_detection.running_rms import MOVES, RunningRms
from drawbar.driving.fault_detection.simulated_hitch_angle import SimulatedHitchAngle
from drawbar.driving.fault_detection.stuck_hitch_sensor import StuckHitchSensor
from drawbar.driving.fault_detection.turning_error import TurningError
from drawbar.safety.sanity import SanitySettings
from drawbar.signals import Actuation, Estimate, FixStatus, Measurement, Pose, SolverStatus, StepRecord
from drawbar.vehicle.parameters import VehicleParameters

_MEAN_TIME = 1.0
"""time that the mean residuals cover, s"""
_RESIDUAL, _FACTOR = math.radians(2.8), 7.0
"""norm of the mean residuals that is a contradiction: rad, and root mean squares, which are larger on rough ground"""
_CLIP = 3.0
"""limits at which one residual is clipped, so that a single false angle is no contradiction"""
_PRIOR, _PRIOR_TIME = 0.0105, 5.0
"""prior root mean square and its weight: rad, s"""
_SPAN = 0.6
"""time that the mean distance of an antenna from its estimate covers, s"""
_ASIDE, _LEAST = 3.0, 0.04
"""root mean squares of it, and m at least, beyond which the antenna is contradicted"""
_SHARE = 0.65
"""of the limit above, where an antenna is contradicted as well"""


class _AntennaResidual:
    """Distance of one antenna from its estimated position."""

    def __init__(self, sample_time: float) -> None:
        """Begin without a sample; `sample_time` in s."""
        self._distances = Recent[float](_SPAN, sample_time)  # m
        self._rms = RunningRms(sample_time)

    def contradicts(self, x: float, y: float, place: Pose, *, moves: bool) -> bool:
        """Update with its position (m, NaN: unknown); return whether the mean distance exceeds its limit."""
        distance = math.hypot(x - place.x, y - place.y)
        if not math.isfinite(distance):
            return False
        self._distances.append(distance)
        mean = fmean(self._distances)
        if moves:
            self._rms.add(mean)
        return self._distances.is_full and mean > _ASIDE * max(self._rms.value, _LEAST)


class FaultExclusion:
    """Contradictions of the positions of both antennas, and of the trailer's angles, over the last samples."""

    def __init__(self, settings: SanitySettings, vehicle: VehicleParameters, sample_time: float) -> None:
        """Begin with nothing excluded; `sample_time` in s."""
        self._hitch_limit = settings.hitch
        self._simulated = SimulatedHitchAngle(vehicle, sample_time)
        self._reversed = ReversedHitchSensor(sample_time)
        self._stuck = StuckHitchSensor(settings.hitch)
        self._angles, self._turning = ContradictingAngles(sample_time), TurningError(vehicle.wheelbase, sample_time)
        self.shares = Shares()
        """at the last sample"""
        self.steering_contradicts = False
        """the tractor does not turn as its front wheels are measured"""
        self._residuals = Recent[tuple[float, float]](_MEAN_TIME, sample_time, least=CONFIRMED)
        self._rms = RunningRms(sample_time, prior=_PRIOR, prior_time=_PRIOR_TIME)  # of their norm, rad
        self._tractor_antenna, self._trailer_antenna = _AntennaResidual(sample_time), _AntennaResidual(sample_time)
        self._positions = self._trailer = 0
        self._moved = False
        """positions drift or have jumped, by the receivers' own velocities"""

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
        """Whether the measurements of the trailer are excluded."""
        return self._trailer >= CONFIRMED

    def update(self, record: StepRecord, *, engaged: bool, moved: bool = False, astray: bool = False) -> None:
        """Update with a step; what is excluded while engaged stays so.

        Args:
            record: of the step.
            engaged: the vehicle is steered.
            moved: positions drift or have jumped.
            astray: the estimate moves in another direction than the tractor's antenna.
        """
        measured = _true_to_scale(record.measurement, record.actuation)
        hitch, joint = _residuals(measured, record.estimate)
        self._residuals.append((hitch, joint))
        contradicted, wrong_wheels = self._contradicted(record, measured, astray=astray)
        # once the trailer is excluded the estimated yaw changes; if it goes astray again, the front wheels lead it
        self.steering_contradicts = astray if self.excludes_trailer else wrong_wheels
        if not (engaged and self.excludes_trailer):
            self._trailer = CONFIRMED if contradicted else self._trailer + 1 if abs(hitch) > self._hitch_limit else 0
        self._moved = moved or (engaged and self._moved)
        if self._moved:
            self._positions = CONFIRMED
        elif self.excludes_trailer:  # they have corrupted the estimate, which rejects correct fixes
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
        """Return a measurement without the trailer's values, where they are excluded."""
        if not self.excludes_trailer:
            return measurement
        nan = math.nan
        return replace(measurement, hitch_angle=nan, trailer_steering=nan, trailer_x=nan, trailer_y=nan)

    def _contradicted(self, record: StepRecord, measured: Measurement, *, astray: bool) -> tuple[bool, bool]:
        """Update the detectors; return whether an angle of the trailer is wrong, and whether the front wheels' is."""
        moves = abs(measured.speed) >= MOVES
        limit = _SHARE if self._antenna_contradicts(record, moves=moves) else 1.0
        residuals = self._angles_share(moves=moves) / limit
        simulated = self._simulated.update(measured, record.estimate)
        reverses = self._reversed.update(measured.hitch_angle, simulated)
        is_stuck = self._stuck.update(
            record.measurement.hitch_angle, record.estimate.hitch_angle, simulated, moves=moves
        )
        self._angles.update(measured.hitch_angle, simulated)
        turning = self._turning.update(record)
        self.shares = Shares(residuals, self._reversed.share, self._angles.share, self._turning.share)
        whose = contradiction(self.shares, turning, astray=astray)
        trailer = residuals > 1.0 or reverses or is_stuck or whose is Contradiction.TRAILER
        return trailer, self._turning.is_large or whose is Contradiction.FRONT_WHEELS

    def _angles_share(self, *, moves: bool) -> float:
        """Return the norm of the mean residuals of both angles as a share of its limit."""
        if not self._residuals.is_full:
            return 0.0
        limit = max(_RESIDUAL, _FACTOR * self._rms.value)
        clipped = ((_clipped(hitch, _CLIP * limit), _clipped(joint, _CLIP * limit)) for hitch, joint in self._residuals)
        mean = math.hypot(*map(fmean, zip(*clipped, strict=True)))
        if moves:
            self._rms.add(min(mean, limit))
        return mean / limit

    def _antenna_contradicts(self, record: StepRecord, *, moves: bool) -> bool:
        """Return whether either antenna is contradicted by the estimate."""
        m, found = record.measurement, record.estimate
        tractor = self._tractor_antenna.contradicts(m.tractor_x, m.tractor_y, found.tractor, moves=moves)
        trailer = self._trailer_antenna.contradicts(m.trailer_x, m.trailer_y, found.trailer, moves=moves)
        return tractor or trailer


def _true_to_scale(measured: Measurement, known: Actuation) -> Measurement:
    """Return a measurement whose angles of hitch and joint are corrected as the step corrects them."""
    hitch = measured.hitch_angle * (1.0 + known.hitch_scale)
    return replace(measured, hitch_angle=hitch, trailer_steering=measured.trailer_steering * (1.0 + known.joint_scale))


def _residuals(measured: Measurement, estimate: Estimate) -> tuple[float, float]:
    """Return measured minus estimated angles of hitch and joint, rad; 0 where one of both is missing."""
    if estimate.status is not SolverStatus.SOLVED:
        return 0.0, 0.0
    hitch = measured.hitch_angle - estimate.hitch_angle
    joint = measured.trailer_steering - estimate.trailer_steering
    return hitch if math.isfinite(hitch) else 0.0, joint if math.isfinite(joint) else 0.0


def _clipped(angle: float, limit: float) -> float:
    return min(max(angle, -limit), limit)


def _both_rejected(record: StepRecord) -> bool:
    """Whether the estimator has rejected both antennas."""
    fixes = (record.estimate.tractor_fix, record.estimate.trailer_fix)
    return all(fix is FixStatus.REJECTED for fix in fixes)
