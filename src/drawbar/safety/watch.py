"""Watch: the newest of controller, recorder and actuators, and when it came; it makes the observation. Pure."""

import math
from collections import deque
from dataclasses import dataclass
from typing import Any

from drawbar.messages import CommandMessage, ControllerState, Heartbeat, Mode, Role, SupervisorState
from drawbar.nanoseconds import seconds
from drawbar.protocols.actuator import Readiness, SteeringReport
from drawbar.safety.conditions import Observation
from drawbar.safety.engagement import STEERING
from drawbar.safety.envelope import is_after
from drawbar.safety.settings import SafetySettings
from drawbar.safety.speeds import Speeds
from drawbar.statuses import FixQuality, Status

_ON_LINE = (0.1, math.radians(3.0))
"""distance, m, and direction, rad, within which a vehicle that is steered has come onto its line"""
_SKIPPED = 0.5
"""for which a receiver may report nothing, as where epochs are lost in transit, without having lost its RTK fix, s"""


@dataclass(slots=True)
class Troubles:
    """When something of the gate's own last went wrong, s, or whether it has."""

    refused: float = -math.inf
    late: float = -math.inf
    lateness: float = 0.0
    """of this tick; a board answers set points, and was sent none for so long, s"""
    unsent: float = -math.inf
    gone: bool = False
    ended: bool = False
    suspended: bool = False
    device: bool = False


class Watch:
    """The newest of everything that engaging and driving depend on."""

    def __init__(self, settings: SafetySettings, *, drives: bool) -> None:
        """Begin with nothing received; `drives`: there is a speed actuator."""
        self._settings, self._drives = settings, drives
        self._fingerprint = settings.fingerprint()
        self._state: ControllerState | None = None
        self._state_time = self._recorded = self._guarded = -math.inf
        self._fixed_since, self._fixed = math.nan, [-math.inf, -math.inf]
        self._overruns: deque[tuple[float, int]] = deque(maxlen=1024)
        self._on_line = False
        """it has been on its line since it was engaged"""
        self.command: CommandMessage | None = None
        """the last one that was admitted"""
        self.speeds = Speeds(settings)
        self.troubles = Troubles()

    def receive_controller(self, time: float, state: ControllerState) -> None:
        """Take in a state of the controller that came at a time, s, unless it or a later one has come before."""
        if self._state is not None and not is_after(state.sequence, self._state.sequence):
            return
        self._state, self._state_time = state, time
        qualities = (state.tractor_quality, state.trailer_quality)
        self._fixed = [
            time if each >= FixQuality.FIXED else last for each, last in zip(qualities, self._fixed, strict=True)
        ]
        worse = any(each < FixQuality.FIXED and each != FixQuality.NONE for each in qualities)
        if worse or time - min(self._fixed) > _SKIPPED:
            self._fixed_since = math.nan
        elif math.isnan(self._fixed_since):
            self._fixed_since = time
        self._overruns.append((time, state.overruns))
        self.speeds.add(time, "wheels", state.wheel_speed)
        self.speeds.add(time, "receiver", state.receiver_speed)

    def receive_heartbeat(self, time: float, beat: Heartbeat) -> None:
        """Take in a heartbeat; a recorder or guard that is not healthy is as good as none."""
        if beat.role is Role.RECORDER:
            self._recorded = time if beat.healthy == 1 else -math.inf
        elif beat.role is Role.GUARD:
            self._guarded = time if beat.healthy == 1 else -math.inf

    def command_valid(self, time: float) -> bool:
        """Return whether the last command may still be obeyed."""
        return self.command is not None and time <= seconds(self.command.valid_until)

    @property
    def mode(self) -> Mode | None:
        """What the controller is doing; None: nothing has been received from it."""
        return None if self.command is None else self.command.mode

    def observe(
        self,
        time: float,
        state: SupervisorState,
        steering: tuple[SteeringReport | None, SteeringReport | None],
        readiness: tuple[Readiness, ...],
    ) -> Observation:
        """Return what is so now, without the parts of operators, envelope and followings."""
        troubles, reported = self.troubles, self._of_controller(time, state)
        return Observation(
            controller_age=time - self._state_time,
            command_valid=self.command_valid(time),
            refused_ago=time - troubles.refused,
            agrees=agrees(self.mode, state),
            run_ended=self.mode is Mode.STOP,
            controller_gone=troubles.gone,
            speed=self.speeds.largest(time) if self.speeds.known(time) else math.nan,
            speed_received=bool(self.speeds.fresh(time)),
            speed_known=self.speeds.known(time),
            speeds_contradict=self.speeds.contradict(time),
            drives=self._drives,
            angle_age=max(
                (time - troubles.lateness - report.angle_time for report in steering if report is not None),
                default=math.inf,
            ),
            steering_error=self._steering_error(steering),
            readiness=readiness,
            late_ago=time - troubles.late,
            suspended=troubles.suspended,
            unsent_ago=time - troubles.unsent,
            device_failed=troubles.device,
            ended=troubles.ended,
            recording=time - self._recorded <= self._settings.timing.recorder,
            guarded=time - self._guarded <= self._settings.timing.guard,
            **reported,
        )

    def _of_controller(self, time: float, supervisor: SupervisorState) -> dict[str, Any]:
        """Return the controller's last state, in the observation's fields."""
        state = self._state
        if state is None:
            return {}
        lateral = largest(state.tractor_lateral_error, state.trailer_lateral_error)
        heading = largest(state.tractor_heading_error, state.trailer_heading_error)
        arrives = lateral <= _ON_LINE[0] and heading <= _ON_LINE[1]
        self._on_line = supervisor in STEERING and (self._on_line or arrives)
        return {
            "configured": state.configuration == self._fingerprint,
            "solved": state.solved,
            "overruns": self._late_steps(time),
            "fixed_for": time - self._fixed_since,
            "fix_age": time - min(self._fixed),
            "correction_age": state.correction_age,
            "lateral_deviation": state.lateral_deviation,
            "heading_deviation": state.heading_deviation,
            "lateral_error": lateral,
            "heading_error": heading,
            "on_line": self._on_line,
            "hitch_angle": state.hitch_angle,
            "backwards": state.status == Status.BACKWARDS,
            "notices": state.notices,
            # while it stops, the gate may have limited what the controller commanded
            "not_following": state.status == Status.STEERING and supervisor is not SupervisorState.STOPPING,
            "wiggled": state.wiggled == 1,
        }

    def _late_steps(self, time: float) -> int:
        """Return by how many the count of late steps has recently grown; one that fell belongs to another process."""
        recent = [count for at, count in self._overruns if time - at <= self._settings.engage.quiet]
        return max(recent[-1] - recent[0], 0) if recent else 0

    def _steering_error(self, steering: tuple[SteeringReport | None, SteeringReport | None]) -> float:
        if self.command is None:
            return math.nan
        wanted = (self.command.tractor_angle, self.command.trailer_angle)
        pairs = zip(wanted, steering, strict=True)
        return largest(*(angle - report.angle for angle, report in pairs if report is not None))


def agrees(mode: Mode | None, state: SupervisorState) -> bool:
    """Return whether the controller's mode fits the gate's state.

    While engaging it may not know yet; while stopping it may have ended its run.
    """
    if state in (SupervisorState.ACTIVE, SupervisorState.DEGRADED):
        return mode is not Mode.IDLE
    return state in STEERING or mode in (None, Mode.IDLE)


def largest(*values: float) -> float:
    """Return the largest magnitude; NaN if there is none, or any is NaN."""
    return math.nan if not values or any(math.isnan(value) for value in values) else max(map(abs, values))
