"""Notices: faults of sensors for the operator, each a cause with its code, sentence and advice.

The gate decides by the remaining measurements, and reports that a position is not known well enough, not which sensor
has been left out, or why. A notice stays until the operator has acknowledged the stop that it led to.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from drawbar.driving.fault_detection.confirmation import Confirmation
from drawbar.driving.fault_detection.fault_exclusion import FaultExclusion
from drawbar.estimation.alignment import YAW_GATE
from drawbar.geometry import wrap
from drawbar.messages import Fixes, GateState, SupervisorState
from drawbar.nanoseconds import seconds
from drawbar.safety.causes import Cause
from drawbar.signals import FixStatus, StepRecord
from drawbar.step.autopilot import Autopilot

MOST = 8
"""that a record holds"""
_SILENT = 0.5
"""after which a receiver or sensor is reported silent, s: single epochs are lost by radio"""
_NOTHING = 1.5
"""the same where nothing at all arrives any more, as when one cable carries everything, s: receivers may have 1 Hz"""
_UNPAIRED = 2.0
"""without an epoch of both receivers, after which their times are reported, s"""
_CHANGED = math.radians(1.5)
"""of the tractor's yaw by two antennas against fixes and angles, rad; of sound ones below 1.3° with roll measured"""
_SCALE = 0.1
"""error of the scale of hitch or joint, less a standard deviation"""
_TURN = 0.5
"""longest between two estimates that show how fast the tractor turns, s"""
_KEPT = frozenset(
    {
        SupervisorState.ENGAGING,
        SupervisorState.ACTIVE,
        SupervisorState.DEGRADED,
        SupervisorState.STOPPING,
        SupervisorState.STOPPED,
        SupervisorState.OVERRIDE,
        SupervisorState.FAULT,
        SupervisorState.ESTOP,
    }
)
"""states in which notices stay"""


@dataclass(slots=True)
class _Heard:
    """When something was received last, s."""

    is_expected: bool = False
    """also where it has never been received"""
    last: float = math.nan
    is_silent: bool = False

    def update(self, time: float, *, heard: bool) -> None:
        if heard or (self.is_expected and math.isnan(self.last)):
            self.last = time
        self.is_silent = time - self.last > _SILENT


@dataclass(slots=True)
class _Pairs:
    """When something was received from each receiver last, and from both in one epoch, s."""

    heard: list[float] = field(default_factory=lambda: [-math.inf, -math.inf])
    together: float = math.nan

    def update(self, time: float, *, heard: tuple[int, int]) -> None:
        if all(heard) or math.isnan(self.together):
            self.together = time
        self.heard = [time if now else before for now, before in zip(heard, self.heard, strict=True)]

    @property
    def never_come(self) -> bool:
        """Whether both send, but for long never for one epoch: their time stamps disagree."""
        newest = max(self.heard)
        return newest - min(self.heard) <= _SILENT and newest - self.together > _UNPAIRED


@dataclass(slots=True)
class _Rejections:
    """Rejected positions of one antenna alone, and rejected yaws."""

    tractor: Confirmation = field(default_factory=Confirmation)
    trailer: Confirmation = field(default_factory=Confirmation)
    yaw: Confirmation = field(default_factory=Confirmation)


class Notices:
    """Faults of sensors over the last epochs and samples."""

    def __init__(self, autopilot: Autopilot, *, has_trailer_receiver: bool) -> None:
        """Begin without notices; errors of the yaw sensors are read from the autopilot."""
        self._alignment = autopilot.library.components["alignment"].live
        self._receivers = (_Heard(is_expected=True), _Heard(is_expected=has_trailer_receiver))
        self._sensors, self._pairs = (_Heard(), _Heard()), _Pairs()
        self._rejections = _Rejections()
        self._newest = math.nan
        """when anything was heard last, s"""
        self._reported: dict[Cause, None] = {}
        self._stays = False
        self._before = math.nan, 0.0  # time and yaw of the last estimate, s, rad

    @property
    def codes(self) -> tuple[int, ...]:
        """Codes of the notices, the oldest first, then zeros; as many as a record holds."""
        codes = [cause.value for cause in self._reported][:MOST]
        return (*codes, *[0] * (MOST - len(codes)))

    def receive_gate(self, state: GateState) -> None:
        """Take in what the gate does."""
        self._stays = state.state in _KEPT

    def receive_fixes(self, fixes: Fixes) -> None:
        """Take in an epoch."""
        time = self._newest = seconds(fixes.epoch)
        for heard, newest in zip(self._receivers, (fixes.tractor.heard, fixes.trailer.heard), strict=True):
            heard.update(time, heard=bool(newest))
        self._pairs.update(time, heard=(fixes.tractor.heard, fixes.trailer.heard))
        for heard, value in zip(self._sensors, (fixes.hitch_angle, fixes.wheel_speed), strict=True):
            heard.update(time, heard=math.isfinite(value))

    def update(
        self, record: StepRecord, exclusion: FaultExclusion, *, drifts: bool, mirrored: bool, far_apart: bool
    ) -> None:
        """Take in a step, what is excluded, and what else was found.

        Args:
            record: of the step.
            exclusion: of sensors.
            drifts: positions do.
            mirrored: the front wheels are.
            far_apart: the antennas are not as far apart as the vehicle is long.
        """
        estimate, rejections = record.estimate, self._rejections
        if estimate.time - self._newest > _NOTHING:
            for each in (*self._receivers, *self._sensors):
                each.update(estimate.time, heard=False)
        fixes = (estimate.tractor_fix, estimate.trailer_fix)
        alone = fixes.count(FixStatus.REJECTED) == 1
        rejections.tractor.update(holds=alone and fixes[0] is FixStatus.REJECTED)
        rejections.trailer.update(holds=alone and fixes[1] is FixStatus.REJECTED)
        rejections.yaw.update(holds=self._yaw_is_far(record))
        present = dict.fromkeys(self._present(exclusion, drifts=drifts))
        if far_apart:
            present[Cause.ANTENNA_DISTANCE] = None
        # where nothing shows how the masts lean, a slope turns the line of both antennas too
        if math.isfinite(record.measurement.tractor_roll) and abs(self._number("yaw.change")) > _CHANGED:
            present[Cause.YAW_CHANGED] = None
        if max(abs(record.actuation.hitch_scale), abs(record.actuation.joint_scale)) > _SCALE:
            present[Cause.ANGLE_SCALE] = None
        if mirrored:  # the trailer's angles contradict an estimate that is turned the wrong way
            present = dict.fromkeys([Cause.STEERING_MIRRORED]) | present
            present.pop(Cause.TRAILER_CONTRADICTS, None)
            self._reported.pop(Cause.TRAILER_CONTRADICTS, None)
        self._reported = (self._reported | present) if self._stays else present

    def _present(self, exclusion: FaultExclusion, *, drifts: bool) -> Iterator[Cause]:
        if any(each.is_silent for each in self._receivers):
            yield Cause.RECEIVER_SILENT
        if self._pairs.never_come:
            yield Cause.RECEIVER_TIMES
        if any(each.is_silent for each in self._sensors):
            yield Cause.SENSOR_SILENT
        drifts |= self._stays and Cause.POSITIONS_DRIFT in self._reported
        if exclusion.excludes_positions:
            yield Cause.POSITIONS_DRIFT if drifts else Cause.POSITIONS_JUMPED
        if self._rejections.tractor.is_confirmed or self._rejections.trailer.is_confirmed:
            yield Cause.POSITION_REJECTED
        if exclusion.excludes_trailer and not drifts:  # an estimate that has followed positions contradicts it, too
            yield Cause.TRAILER_CONTRADICTS
        if exclusion.steering_contradicts:
            yield Cause.STEERING_CONTRADICTS
        if self._rejections.yaw.is_confirmed or self._number("yaw_rate.exclusion") > 0.0:
            yield Cause.YAW_REJECTED

    def _yaw_is_far(self, record: StepRecord) -> bool:
        """Return whether the tractor's yaw by two antennas is outside its gate, brought up to the sample."""
        measurement, now, before = record.measurement, record.estimate, self._before
        self._before = now.time, now.tractor.yaw
        elapsed = now.time - before[0]
        rate = wrap(now.tractor.yaw - before[1]) / elapsed if 0.0 < elapsed <= _TURN else 0.0
        age = measurement.tractor_attitude_age + self._number("yaw.latency")
        yaw = measurement.tractor_yaw + self._number("yaw.error") + rate * age
        return math.isfinite(yaw) and abs(wrap(yaw - now.tractor.yaw)) > YAW_GATE

    def _number(self, name: str) -> float:
        """Return a number of the autopilot's alignment."""
        return float(self._alignment.array(name)[0])
