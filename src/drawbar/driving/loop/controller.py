"""Controller: the control step between measurements and messages to the gate; time is given to it."""

import math
from dataclasses import replace

from drawbar.config import Configuration
from drawbar.driving.fault_detection.notices import MOST
from drawbar.driving.fault_detection.rollback import Rollback
from drawbar.driving.fault_detection.sensor_faults import Change, SensorFaults
from drawbar.driving.loop.curve_limits import within_envelope
from drawbar.driving.loop.driven_line import DrivenLine
from drawbar.driving.loop.estimate_uncertainty import Uncertainty, uncertainty_of
from drawbar.driving.loop.field_fence import FieldFence
from drawbar.driving.loop.line_selection import LineSelection
from drawbar.driving.loop.tube_exit import TubeExit
from drawbar.geometry import wrap
from drawbar.guidance.path import Path
from drawbar.messages import CommandMessage, ControllerState, Fixes, GateState, Mode, SupervisorState
from drawbar.safety.causes import Cause
from drawbar.signals import Command, FixQuality, Measurement, Status, StepRecord
from drawbar.step.build import build_autopilot

VALIDITY = 190_000_000
"""for how long a command may act without a new one, ns"""
_STANDS = 0.1
"""speed below which the vehicle stands, m/s; AgOpenGPS boards steer from 0.06 on"""
_ROLLED = 2.0
"""way after which the motion of the antennas shows the heading, m"""
_LATER = 3.0
"""times the standard deviation at which the gate stops the vehicle, at which the step itself gives up"""
_STEERED = (SupervisorState.ENGAGING, SupervisorState.ACTIVE, SupervisorState.DEGRADED, SupervisorState.STOPPING)


class Controller:
    """Feeds the autopilot, engaged or not, and sends the gate its commands and state.

    While it is not engaged, it looks on: a run begins by itself wherever the vehicle comes near the path.
    """

    def __init__(
        self, configuration: Configuration, path: Path, fingerprint: int, fence: FieldFence | None = None
    ) -> None:
        """Build the autopilot.

        Args:
            configuration: of the run.
            path: to drive along.
            fingerprint: of the safety settings that the gate has.
            fence: of the field; None: it has no boundary that is known, or the gate's decisions are those of a log.

        Raises:
            PathError: the gate would not let the path be driven at the set speed.
            DrawbarError: the autopilot cannot be built.
        """
        self._configuration, self._fingerprint = configuration, fingerprint
        self._fence, self._at_edge = fence, False
        self._tube = TubeExit(configuration.sample_time)
        self._drives = configuration.devices is not None and configuration.devices.speed == "isobus"
        line = DrivenLine.first(configuration, path)
        self.wiggled = False
        """the actuators have passed their wiggle test"""
        self._autopilot = build_autopilot(_steering_on(within_envelope(configuration)))
        self._autopilot.begin(path)
        self._autopilot.set_engaged(False)
        self._stands = False
        """the driver has halted"""
        self._wheel_speed = math.nan
        """as measured last, m/s"""
        self._made_engaged = False
        """the newest command was made while engaged: before that it repeats the steering, with a speed of zero"""
        self._rolled = 0.0
        """since the estimate began, m"""
        self._uncertainty_of = uncertainty_of(self._autopilot, configuration)
        self.uncertainty = Uncertainty()
        """of the newest estimate"""
        self._faults = SensorFaults(configuration, self._autopilot)
        self._rollback = Rollback(self._autopilot, configuration.sample_time)
        self._lines = LineSelection(line, self._autopilot, self._rollback)
        self._gate: GateState | None = None
        self.has_corrected = False
        """the newest preparation has found another answer to its sample, which `repeat` returns"""
        self._sequence = self._solved = self._overruns = 0
        self._record: StepRecord | None = None
        self._status = Status.POSITION
        self._command = Command(time=0.0, tractor_steering=0.0, trailer_steering=0.0, speed=0.0)

    @property
    def receivers(self) -> int:
        """How many there are: the tractor's, and the trailer's or none."""
        return 1 + self._configuration.has_trailer_receiver

    @property
    def engaged(self) -> bool:
        """Whether the gate lets commands act."""
        return self._gate is not None and bool(self._gate.steers) and self._gate.state in _STEERED

    @property
    def ends(self) -> bool:
        """Whether the newest command ends a run that the gate lets act."""
        return self._mode() is Mode.STOP

    def receive_gate(self, state: GateState) -> None:
        """Take in what the gate does."""
        before, self._gate = self.engaged, state
        self._faults.receive_gate(state)
        if self.engaged != before:
            self._autopilot.set_engaged(self.engaged)
            self._stands = False
            self._rollback.clear()
            if self._fence is not None:
                self._fence.begin()
            self._lines.retry()
        offset = state.line * self._configuration.path.working_width
        self._lines.choose(offset, state.nudge, self._record, engaged=self.engaged)
        wish = state.set_speed if math.isfinite(state.set_speed) else self._configuration.speed
        self._autopilot.set_speed(max(0.0, min(wish, state.speed_limit, self._configuration.speed)))

    def receive_fixes(self, fixes: Fixes) -> None:
        """Take in an epoch of the receivers, also one of no sample."""
        self._faults.receive_fixes(fixes, hitch_contradicts=self._status == Status.HITCH)

    def feedback(self, measurement: Measurement, now: int) -> CommandMessage:
        """Return the command that answers a measurement; call prepare() once it is out."""
        self._wheel_speed = measurement.speed
        if not self.engaged and self._is_to_begin(measurement) and self._lines.begin_beside(measurement):
            self._rolled = 0.0
        if self.engaged:
            measurement = self._faults.without_faults(measurement)
            self._halt(measurement)
        self._status, self._command = self._rollback.feedback(measurement)
        if abs(measurement.speed) >= _STANDS:
            self._rolled += abs(measurement.speed) * self._configuration.sample_time
        self._measurement, self._made_engaged = measurement, self.engaged
        return self.repeat(now)

    def _is_to_begin(self, measurement: Measurement) -> bool:
        """Return whether a run is over or has not begun, or another one is to begin."""
        over = self._status.has_ended or self._status is Status.START
        return over or self._lines.is_to_begin(measurement, self._record)

    def _halt(self, measurement: Measurement) -> None:
        """Let the steering rest, as measured, while the driver halts: boards and valves turn no wheel then.

        Else commands and angles would go apart, as if a steering did not follow or a sensor were wrong.
        """
        stands = not self._drives and abs(measurement.speed) < _STANDS
        if stands is not self._stands:
            self._stands = stands
            self._autopilot.set_engaged(not stands)
            self._rollback.clear()

    def repeat(self, now: int) -> CommandMessage:
        """Return the newest command again, which acts until the next sample."""
        self._sequence += 1
        return CommandMessage(
            sequence=self._sequence % 2**32,
            time=now,
            valid_until=now + VALIDITY,
            mode=self._mode(),
            tractor_angle=self._command.tractor_steering,
            trailer_angle=self._joint(),
            speed=self._command.speed,
        )

    def _joint(self) -> float:
        """Return the joint's set point in the sign in which it is measured, rad.

        Where its angle is excluded, the one that is measured: the joint then stays, instead of being turned by a wrong
        angle until that is right.
        """
        measured = math.nan if self._gate is None else self._gate.trailer_angle
        if self._faults.exclusion.excludes_trailer and math.isfinite(measured):
            return measured
        return self._configuration.vehicle.joint_sign * self._command.trailer_steering

    def prepare(self, late: bool) -> StepRecord:
        """Do what can be done before the next measurement; return the record of the step.

        late: the command left too late.
        """
        uncertainty, self.has_corrected = self._newest_uncertainty(), False
        self._autopilot.prepare()
        record = self._autopilot.record()
        self._overruns += late
        if self._status is Status.TIME and self._record is not None:  # nothing was taken in: what was known stays
            return record
        self._solved = self._solved + 1 if self._status.is_new_command and not record.solver_failures else 0
        if not self._status.has_ended or self._record is None:
            self._record = record
        if not self._status.has_ended:  # a run that has ended estimates nothing more
            if (change := self._faults.update(record, engaged=self.engaged)) is not None:
                self._recompute(change)
            self._faults.update_notices(record)
            self._tube.update(record, engaged=self.engaged)
            self._at_edge = self._fence is not None and self._fence.is_reached(record, self._lines.line)
            self.uncertainty = Uncertainty() if self._faults.exclusion.is_active else uncertainty
        return record

    def _newest_uncertainty(self) -> Uncertainty:
        """Return that of the newest estimate: before it is prepared, which counts the next fix as a usual one."""
        if not self._status.is_new_command or self._faults.exclusion.is_active:
            return Uncertainty()
        uncertainty = self._uncertainty_of(self._autopilot.record().estimate)
        return uncertainty if self._shows_heading() else replace(uncertainty, heading=math.nan)

    def _shows_heading(self) -> bool:
        """Whether a yaw or the hitch angle is measured, or the vehicle has rolled since the estimate began.

        Else only the distance of both antennas shows the hitch angle, and a centimetre of a wrong length is as much as
        10 degrees.
        """
        measured = self._measurement
        return math.isfinite(measured.tractor_yaw) or math.isfinite(measured.hitch_angle) or self._rolled >= _ROLLED

    def _recompute(self, change: Change) -> None:
        """Compute the last seconds again; the newest answer replaces the one that a faulty sensor has corrupted."""
        answer = self._rollback.recompute(change)
        if answer is not None:
            self._status, self._command = answer
            self.has_corrected = True

    def state(self, now: int, *, correction_age: float, receiver_speed: float) -> ControllerState:
        """Return how the controller is after its newest step.

        Args:
            now: monotonic time, ns.
            correction_age: of the older of both receivers' corrections, NaN where not known, s.
            receiver_speed: over ground, NaN where not known, m/s.
        """
        record, measurement = self._record, self._measurement
        assert record is not None
        tractor, trailer, line = record.reference.tractor, record.reference.trailer, self._lines.line
        return ControllerState(
            sequence=self._sequence % 2**32,
            time=now,
            valid_until=now + 2 * round(self._configuration.sample_time * 1e9),
            configuration=self._fingerprint,
            tractor_quality=int(measurement.tractor_fix_quality),
            trailer_quality=int(self._trailer_quality(measurement)),
            wiggled=int(self.wiggled),
            status=int(Status.BACKWARDS if self._faults.receivers_are_swapped else self._status),
            flags=int(record.flags),
            solved=self._solved,
            overruns=self._overruns,
            correction_age=correction_age,
            lateral_deviation=self.uncertainty.lateral,
            heading_deviation=self.uncertainty.heading,
            tractor_lateral_error=tractor.lateral_error,
            trailer_lateral_error=trailer.lateral_error,
            tractor_heading_error=wrap(record.estimate.tractor.yaw - tractor.closest[2]),
            trailer_heading_error=wrap(record.estimate.trailer.yaw - trailer.closest[2]),
            hitch_angle=record.estimate.hitch_angle,
            wheel_speed=self._wheel_speed,
            receiver_speed=receiver_speed,
            line_offset=line.offset + line.nudge,
            against=int(line.against),
            notices=self._notices(),
        )

    def _notices(self) -> tuple[int, ...]:
        """Return the codes of what the controller has found, as many as a record holds: what acts before mere words."""
        edge = (Cause.FIELD_EDGE.value,) if self._at_edge else ()
        return (*edge, *self._tube.notices, *self._faults.notices)[:MOST]

    def _trailer_quality(self, measurement: Measurement) -> FixQuality:
        return measurement.tractor_fix_quality if self.receivers == 1 else measurement.trailer_fix_quality

    def _mode(self) -> Mode:
        if self._status.has_ended:
            return Mode.STOP if self.engaged else Mode.IDLE
        drives = self.engaged and self._made_engaged
        return Mode.DRIVE if drives and self._status < Status.POSITION else Mode.IDLE


def _steering_on(configuration: Configuration) -> Configuration:
    """Return the configuration of a step that steers on without fixes while the gate stops the vehicle for that.

    A step that ends its run holds the wheels where they were on average.
    """
    sanity, stops = configuration.sanity, configuration.safety.drive.lateral_deviation
    later = {"blind_deviation": max(sanity.blind_deviation, _LATER * stops)}
    return configuration.model_copy(update={"sanity": sanity.model_copy(update=later)})
