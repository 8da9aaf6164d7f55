"""Controller: the control step between measurements and messages to the gate; time is given to it."""

import math

from drawbar.config import Configuration
from drawbar.driving.certainty import certainty
from drawbar.driving.doubts import Doubts
from drawbar.geometry import wrap
from drawbar.guidance.path import Path
from drawbar.messages import CommandMessage, ControllerState, GateState, Mode, SupervisorState
from drawbar.signals import Command, Measurement, Status, StepRecord
from drawbar.step.build import build_autopilot

VALIDITY = 190_000_000
"""for how long a command may act without a new one, ns"""
_STEERED = (SupervisorState.ENGAGING, SupervisorState.ACTIVE, SupervisorState.DEGRADED, SupervisorState.STOPPING)


class Controller:
    """Feeds the autopilot, engaged or not, and says to the gate what it wants and how it is.

    While it is not engaged, it looks on: a run begins by itself wherever the vehicle comes near the path.
    """

    def __init__(self, configuration: Configuration, path: Path, fingerprint: int, *, wiggled: bool = False) -> None:
        """Build the autopilot.

        Args:
            configuration: of the run.
            path: to drive along.
            fingerprint: of the safety settings that the gate has.
            wiggled: the actuators have passed their wiggle test.

        Raises:
            DrawbarError: the autopilot cannot be built.
        """
        self._configuration, self._path, self._fingerprint = configuration, path, fingerprint
        self._wiggled = wiggled
        self._autopilot = build_autopilot(configuration)
        self._autopilot.begin(path)
        self._autopilot.set_engaged(False)
        self._certainty = certainty(self._autopilot, configuration)
        self._doubts = Doubts(configuration.sanity)
        self._gate: GateState | None = None
        self._sequence = self._solved = self._overruns = 0
        self._status = Status.POSITION
        self._command = Command(time=0.0, tractor_steering=0.0, trailer_steering=0.0, speed=0.0)

    @property
    def engaged(self) -> bool:
        """Whether the gate lets commands act."""
        return self._gate is not None and bool(self._gate.steers) and self._gate.state in _STEERED

    def hear(self, state: GateState) -> None:
        """Take in what the gate does."""
        before, self._gate = self.engaged, state
        if self.engaged != before:
            self._autopilot.set_engaged(self.engaged)
        wish = state.set_speed if math.isfinite(state.set_speed) else self._configuration.speed
        self._autopilot.set_speed(max(0.0, min(wish, state.speed_limit, self._configuration.speed)))

    def feedback(self, measurement: Measurement, now: int) -> CommandMessage:
        """Return the command that answers a measurement; call prepare() once it is out."""
        if not self.engaged and (self._status.has_ended or self._status is Status.START):
            self._begin_beside(measurement)
        if self.engaged:
            measurement = self._doubts.without(measurement)
        self._status, self._command = self._autopilot.feedback(measurement)
        self._measurement = measurement
        return self.repeat(now)

    def repeat(self, now: int) -> CommandMessage:
        """Return the newest command again, which acts until the next sample."""
        self._sequence += 1
        joint = self._configuration.vehicle.joint_sign * self._command.trailer_steering
        return CommandMessage(
            sequence=self._sequence % 2**32,
            time=now,
            valid_until=now + VALIDITY,
            mode=self._mode(),
            tractor_angle=self._command.tractor_steering,
            trailer_angle=joint,
            speed=self._command.speed,
        )

    def prepare(self, late: bool) -> StepRecord:
        """Do what can be done before the next measurement; return the record of the step.

        late: the command left too late.
        """
        self._autopilot.prepare()
        record = self._autopilot.record()
        self._overruns += late
        self._solved = self._solved + 1 if self._status.is_new_command and not record.solver_failures else 0
        if not self._status.has_ended:  # a run that has ended estimates nothing more
            self._record = record
            self._doubts.look(record, engaged=self.engaged)
            known = self._status.is_new_command and not self._doubts.exist
            self._deviations = self._certainty(record.estimate) if known else (math.nan, math.nan)
        return record

    def state(self, now: int, *, correction_age: float, receiver_speed: float) -> ControllerState:
        """Return how the controller is after its newest step.

        Args:
            now: monotonic time, ns.
            correction_age: of the older of both receivers' corrections, NaN where not known, s.
            receiver_speed: over ground, NaN where not known, m/s.
        """
        record, measurement = self._record, self._measurement
        lateral, heading = self._deviations
        tractor, trailer = record.reference.tractor, record.reference.trailer
        return ControllerState(
            sequence=self._sequence % 2**32,
            time=now,
            valid_until=now + 2 * round(self._configuration.sample_time * 1e9),
            configuration=self._fingerprint,
            tractor_quality=int(measurement.tractor_fix_quality),
            trailer_quality=int(measurement.trailer_fix_quality),
            wiggled=int(self._wiggled),
            status=int(self._status),
            flags=int(record.flags),
            solved=self._solved,
            overruns=self._overruns,
            correction_age=correction_age,
            lateral_deviation=lateral,
            heading_deviation=heading,
            tractor_lateral_error=tractor.lateral_error,
            trailer_lateral_error=trailer.lateral_error,
            tractor_heading_error=wrap(record.estimate.tractor.yaw - tractor.closest[2]),
            trailer_heading_error=wrap(record.estimate.trailer.yaw - trailer.closest[2]),
            hitch_angle=record.estimate.hitch_angle,
            wheel_speed=measurement.speed,
            receiver_speed=receiver_speed,
        )

    def _mode(self) -> Mode:
        if self._status.has_ended:
            return Mode.STOP if self.engaged else Mode.IDLE
        return Mode.DRIVE if self.engaged and self._status < Status.POSITION else Mode.IDLE

    def _begin_beside(self, measurement: Measurement) -> None:
        """Let the next sample begin a run where the path is nearest, if the position is known."""
        x, y = measurement.tractor_x, measurement.tractor_y
        if not math.isfinite(x + y):
            return
        progress, _ = self._path.project(x, y, 0.0, self._path.length)
        self._autopilot.begin(self._path, at=min(max(progress, 0.0), math.nextafter(self._path.length, 0.0)))
        self._autopilot.set_engaged(False)
