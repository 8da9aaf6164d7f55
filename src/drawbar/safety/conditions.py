"""Conditions: which causes are present in what is observed now. Pure, without numpy."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from drawbar.protocols.actuator import Readiness
from drawbar.safety.causes import BY_READINESS, Cause, Response
from drawbar.safety.settings import SafetySettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Observation:
    """What is known at one instant; the defaults are what total silence leaves. Ages and times in s."""

    controller_age: float = math.inf
    """of the controller's state"""
    command_valid: bool = False
    """the last command may still be obeyed"""
    refused_ago: float = math.inf
    """time since a record of the controller was refused"""
    clips: int = 0
    """commands in a row that were limited"""
    agrees: bool = True
    """controller and gate mean the same about whether a run is on"""
    run_ended: bool = False
    """the controller reports that its run is over"""
    controller_gone: bool = False
    """its process has ended"""
    configured: bool = False
    """the controller goes by the same settings"""
    solved: int = 0
    """steps in a row"""
    overruns: int = 0
    """within `engage.quiet`"""
    fixed_for: float = math.nan
    """for how long both receivers have had fixed ambiguities; NaN: they have not"""
    fix_age: float = math.inf
    """time since the worse receiver last had fixed ambiguities"""
    correction_age: float = math.nan
    lateral_deviation: float = math.nan
    """m"""
    heading_deviation: float = math.nan
    """rad"""
    lateral_error: float = math.nan
    """larger magnitude of both bodies, m"""
    on_line: bool = False
    """they have been on the line since they were engaged"""
    heading_error: float = math.nan
    """larger magnitude of both bodies, rad"""
    hitch_angle: float = math.nan
    """rad"""
    speed: float = math.nan
    """largest recent magnitude, m/s"""
    speed_received: bool = False
    """one of its sources is fresh"""
    speed_known: bool = False
    """a source is fresh, and no other fresh one contradicts it"""
    speeds_contradict: bool = False
    """its sources differ by a factor"""
    drives: bool = False
    """there is a speed actuator"""
    angle_age: float = math.inf
    """of the older of the measured steering angles"""
    steering_error: float = math.nan
    """largest difference of a measured angle from the controller's command, rad"""
    stuck: bool = False
    """a steering does not follow its set point"""
    reversed: bool = False
    """a steering moves away from its set point"""
    jumped: bool = False
    """a measured steering angle has jumped"""
    released: bool = False
    """an actuator was engaged and is not any more, and the operator did not take over"""
    readiness: tuple[Readiness, ...] = ()
    """of all actuators"""
    late_ago: float = math.inf
    """time since a tick of the gate came late"""
    suspended: bool = False
    """the computer was suspended since the gate started"""
    unsent_ago: float = math.inf
    """time since a frame could not be sent"""
    device_failed: bool = False
    """the program of an actuator raised an error"""
    ended: bool = False
    """the gate was told to end"""
    operator_age: float = math.inf
    """since the last message of the operator who engaged; before that, of any"""
    backwards: bool = False
    """the antennas move backwards, as the controller reports"""
    notices: tuple[int, ...] = ()
    """codes of the causes that the controller reports"""
    not_following: bool = False
    """a steering contradicts its commands, as the controller reports, which has ended its run for it while driving"""
    recording: bool = False
    """the recorder is alive and writes"""
    guarded: bool = False
    """the guard is alive"""
    emergency_tried: bool = False
    wiggled: bool = False


Present = Callable[[Observation, SafetySettings], bool]
# What is not known is NaN, and counts as present: hence `not (x <= limit)`.
_PRESENT: dict[Cause, Present] = {
    Cause.CONTROLLER_SILENT: lambda o, s: not (o.controller_age <= s.timing.controller),
    Cause.COMMAND_EXPIRED: lambda o, s: not o.command_valid,
    Cause.COMMAND_REFUSED: lambda o, s: o.refused_ago < s.engage.clean,
    Cause.COMMAND_LIMITED: lambda o, s: o.clips >= s.envelope.clips,
    Cause.MODE: lambda o, s: not o.agrees,
    Cause.CONFIGURATION: lambda o, s: not o.configured,
    Cause.UNPROVED: lambda o, s: o.solved < s.engage.solved,
    Cause.UNSOLVED: lambda o, s: o.solved == 0,
    Cause.OVERRUN: lambda o, s: o.overruns > 0,
    Cause.OVERRUNS: lambda o, s: o.overruns >= s.drive.overruns,
    Cause.CONTROLLER_STOPS: lambda o, s: o.run_ended,
    Cause.CONTROLLER_GONE: lambda o, s: o.controller_gone,
    Cause.FIX_TOO_NEW: lambda o, s: not (o.fixed_for >= s.engage.fixed),
    Cause.FIX_LOST: lambda o, s: not (o.fix_age <= s.timing.fix),
    Cause.CORRECTIONS_OLD: lambda o, s: not (o.correction_age <= s.engage.correction_age),
    Cause.CORRECTIONS_LOST: lambda o, s: not (o.correction_age <= s.drive.correction_age),
    Cause.POSITION_UNSURE: lambda o, s: not (o.lateral_deviation <= s.engage.lateral_deviation),
    Cause.POSITION_LOST: lambda o, s: not (o.lateral_deviation <= s.drive.lateral_deviation),
    Cause.HEADING_UNSURE: lambda o, s: not (o.heading_deviation <= s.engage.heading_deviation),
    Cause.OFF_LINE: lambda o, s: not (o.lateral_error <= s.engage.lateral_error),
    Cause.LINE_LOST: lambda o, s: not (o.lateral_error <= (s.drive.leaving if o.on_line else s.drive.lateral_error)),
    Cause.ACROSS_LINE: lambda o, s: not (o.heading_error <= s.engage.heading_error),
    Cause.HITCH_ANGLE: lambda o, s: not (abs(o.hitch_angle) <= s.engage.hitch_angle),
    Cause.HITCH_FOLDED: lambda o, s: not (abs(o.hitch_angle) <= s.drive.hitch_angle),
    Cause.RECEIVERS_SWAPPED: lambda o, s: o.backwards,
    Cause.SENSORS_LOST: lambda o, s: not (o.speed_received or o.fix_age <= s.timing.fix + s.timing.speed),
    Cause.TOO_SLOW: lambda o, s: not (o.drives or o.speed >= s.engage.speed),
    Cause.TOO_FAST: lambda o, s: o.speed > s.envelope.speed,
    Cause.SPEED_UNKNOWN: lambda o, s: not o.speed_known,
    Cause.SPEEDS_CONTRADICT: lambda o, s: o.speeds_contradict,
    Cause.STEERING_OLD: lambda o, s: not (o.angle_age <= s.timing.angle),
    Cause.STEERING_LOST: lambda o, s: not (o.angle_age <= s.timing.angle_lost),
    Cause.STEERING_APART: lambda o, s: not (o.steering_error <= s.engage.steering_error),
    Cause.STEERING_STUCK: lambda o, s: o.stuck or o.not_following,
    Cause.STEERING_REVERSED: lambda o, s: o.reversed,
    Cause.STEERING_JUMPED: lambda o, s: o.jumped,
    Cause.ACTUATOR_RELEASED: lambda o, s: o.released,
    Cause.GATE_LATE: lambda o, s: o.late_ago < s.engage.clean,
    Cause.SUSPENDED: lambda o, s: o.suspended,
    Cause.NOT_SENT: lambda o, s: o.unsent_ago < s.engage.clean,
    Cause.DEVICE: lambda o, s: o.device_failed,
    Cause.ENDED: lambda o, s: o.ended,
    Cause.NO_OPERATOR: lambda o, s: not (o.operator_age <= s.drive.operator),
    Cause.NOT_RECORDING: lambda o, s: s.engage.recorder and not o.recording,
    Cause.NOT_GUARDED: lambda o, s: not o.guarded,
    Cause.EMERGENCY_UNTRIED: lambda o, s: s.engage.emergency_test and not o.emergency_tried,
    Cause.WIGGLE_UNTRIED: lambda o, s: s.engage.wiggle_test and not o.wiggled,
}

_REPORTED = (
    Cause.POSITION_REJECTED,
    Cause.ANTENNA_DISTANCE,
    Cause.FIELD_EDGE,
    Cause.STEERING_MIRRORED,
    Cause.STEERING_CONTRADICTS,
)
"""those of the controller's notices that are more than words to the operator"""
_ON_LINE = (Cause.OUTSIDE_TUBE, Cause.TUBE_LOST)
"""those that count once the line has been reached"""
_SPECIFIC = {Cause.ACTUATOR_RELEASED: -1, Cause.GATE_LATE: 1}
"""causes that explain less, or more, than the others of the same response"""


def present(observation: Observation, settings: SafetySettings) -> tuple[Cause, ...]:
    """Return the causes that are present, in the order of their codes."""
    found = {cause for cause, holds in _PRESENT.items() if holds(observation, settings)}
    reported = (*_REPORTED, *(_ON_LINE if observation.on_line else ()))
    found |= {cause for cause in reported if cause.value in observation.notices}
    found |= {BY_READINESS[each] for each in observation.readiness if each is not Readiness.READY}
    return tuple(sorted(found, key=lambda cause: int(cause.value)))


def worst(causes: tuple[Cause, ...]) -> tuple[Response, Cause | None]:
    """Return the strongest response that the causes ask for while driving, and the first cause that asks for it.

    That an actuator has released is what all its troubles look like: any other cause is more specific. A gate that
    came late finds commands that expired while they waited for it.
    """
    strongest = max(causes, key=lambda cause: (cause.response, _SPECIFIC.get(cause, 0)), default=None)
    return (Response.NONE, None) if strongest is None else (strongest.response, strongest)
