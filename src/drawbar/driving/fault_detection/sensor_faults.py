"""Sensor faults: what all detectors of a drive find, and what the step is given in place of the measurements.

Epochs of the receivers and steps of the autopilot go in. Out come measurements without the faulty sensors, the change
with which the last samples are to be computed again (rollback.py), and notices for the operator.
"""

import math
from collections.abc import Callable
from dataclasses import replace

from drawbar.config import Configuration
from drawbar.driving.fault_detection.antenna_distance import AntennaDistance
from drawbar.driving.fault_detection.antennas_apart import AntennasApart
from drawbar.driving.fault_detection.contradicting_speeds import ContradictingSpeeds
from drawbar.driving.fault_detection.course_error import CourseError
from drawbar.driving.fault_detection.fault_exclusion import FaultExclusion
from drawbar.driving.fault_detection.mirrored_steering import MirroredSteering
from drawbar.driving.fault_detection.notices import Notices
from drawbar.driving.fault_detection.position_drift import PositionDrift
from drawbar.driving.fault_detection.swapped_receivers import SwappedReceivers
from drawbar.driving.fault_detection.wrong_yaw_rate import WrongYawRate
from drawbar.messages import Fixes, GateState
from drawbar.safety.causes import Cause
from drawbar.signals import FixStatus, Measurement, StepRecord
from drawbar.step.autopilot import Autopilot

Change = Callable[[Measurement], Measurement]


class SensorFaults:
    """All detectors, and what is done about their findings while the vehicle is steered."""

    def __init__(self, configuration: Configuration, autopilot: Autopilot) -> None:
        """Begin with nothing found; errors of the yaw sensors are read from the autopilot."""
        vehicle, sample_time = configuration.vehicle, configuration.sample_time
        self.exclusion = FaultExclusion(configuration.sanity, vehicle, sample_time)
        self._drift, self._swapped, self._speeds = PositionDrift(), SwappedReceivers(), ContradictingSpeeds()
        self._mirrored = MirroredSteering(vehicle, sample_time)
        self._course = CourseError(vehicle.masts.tractor.forward, sample_time)
        self._apart = AntennasApart(vehicle.masts, sample_time)
        self._distance = AntennaDistance(vehicle, sample_time)
        self._yaw_rate = WrongYawRate(autopilot)
        self._notices = Notices(autopilot, has_trailer_receiver=configuration.has_trailer_receiver)
        self._gate: GateState | None = None
        self.dead_reckons = False
        """positions are where the velocities have led since both antennas began to drift"""
        self._jumped = False
        """positions have jumped since it was engaged: where the antennas were before is not known any more"""

    @property
    def receivers_are_swapped(self) -> bool:
        """Whether they are, or the vehicle rolls backwards."""
        return self._swapped.found

    @property
    def notices(self) -> tuple[int, ...]:
        """Codes of the notices, as many as a record holds."""
        return self._notices.codes

    def receive_gate(self, state: GateState) -> None:
        """Take in what the gate does."""
        self._gate = state
        self._notices.receive_gate(state)

    def receive_fixes(self, fixes: Fixes, *, hitch_contradicts: bool) -> None:
        """Take in an epoch of the receivers, also one of no sample.

        hitch_contradicts: the run has ended as the hitch angle contradicts the motion.
        """
        self._drift.receive_fixes(fixes)
        self._course.receive_fixes(fixes)
        self._notices.receive_fixes(fixes)
        self._swapped.receive_fixes(fixes)
        self._speeds.receive_fixes(fixes)
        forwards = not self._swapped.found  # backwards it turns the other way
        angle = self._gate.tractor_angle if self._gate and forwards else math.nan
        lost = self._gate is not None and self._gate.cause == Cause.POSITION_LOST.value
        suspected = lost or hitch_contradicts or self.exclusion.steering_contradicts
        self._mirrored.receive_fixes(fixes, angle, suspected=suspected)

    def without_faults(self, measurement: Measurement) -> Measurement:
        """Return a measurement without what is excluded, with positions by dead reckoning where they drift."""
        if self._speeds.found:
            measurement = replace(measurement, speed=math.nan)
        if self.dead_reckons:
            return self.exclusion.without_trailer(self._drift.dead_reckoned(measurement))
        return self.exclusion.without_excluded(measurement)

    def update(self, record: StepRecord, *, engaged: bool) -> Change | None:
        """Update with a step.

        An estimate that has followed both antennas has turned; from then on the velocities lead. Positions that they
        lead to already are not undone.

        Returns:
            How the measurements of the last samples are to be changed before these are computed again; None: as they
            are, nothing new is excluded.
        """
        change = self._update(record, engaged=engaged)
        if change is not None:
            self._course.clear()
        return change

    def _update(self, record: StepRecord, *, engaged: bool) -> Change | None:
        """Update the detectors that exclude sensors; return as `update` does."""
        before = self.exclusion.excludes_trailer
        self._jumped = engaged and (self._jumped or self._drift.has_jumped)
        drifts, yaw_rate_is_wrong = self._drifts(record), self._yaw_rate.update()
        self._course.update(record)
        astray = self._course.is_large and self._drift.tractor_fits and not self.receivers_are_swapped
        self.exclusion.update(record, engaged=engaged, moved=drifts or self._jumped, astray=astray)
        if not engaged:
            self.dead_reckons = False
            return None
        if drifts and not (self.dead_reckons or self._jumped):
            self._drift.begin_dead_reckoning()
            self.dead_reckons = True
            return self.exclusion.without_excluded
        if self.exclusion.excludes_trailer and not before:
            return self.exclusion.without_trailer if self.dead_reckons else self.exclusion.without_excluded
        return self._yaw_rate.excluded if yaw_rate_is_wrong else None

    def update_notices(self, record: StepRecord) -> None:
        """Update the notices with a step, once its samples have been computed again."""
        self._notices.update(
            record,
            self.exclusion,
            drifts=self.dead_reckons,
            mirrored=self._mirrored.found,
            far_apart=self._distance.update(record),
        )

    def _drifts(self, record: StepRecord) -> bool:
        """Return whether positions drift: of both antennas, or slowly of one that the estimate follows."""
        tractor, trailer = record.estimate.tractor_fix, record.estimate.trailer_fix
        return self._drift.is_detected | self._drift.drifts_slowly(
            tractor=tractor is not FixStatus.REJECTED,
            trailer=trailer is not FixStatus.REJECTED,
            apart=self._apart.update(record),
        )
