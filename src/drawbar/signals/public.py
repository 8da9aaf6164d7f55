"""Public signals: what enters and leaves one control step, as an exported library's caller sees it too.

Measured positions are those of the two antennas. Estimates, plans and the truth speak of one point on the ground for
each body: the middle of the tractor's rear axle, and the trailer's tracked point, `vehicle.trailer_antenna` ahead of
its axle. Yaw is continuous along a run. A missing value is NaN.
"""

import math
from dataclasses import dataclass

from drawbar.signals.quantities import Metres, MetresPerSecond, Radians, RadiansPerSecond, Ratio, Seconds
from drawbar.signals.structs import as_struct
from drawbar.statuses import FixQuality, FixStatus, Flag, GateVerdict, GuidanceStatus, SolverStatus, Status


@dataclass(frozen=True, slots=True, kw_only=True)
class PathNode:
    """One pose of a path's table."""

    arc_length: Metres
    """from the path's start"""
    x: Metres
    y: Metres
    yaw: Radians
    """continuous along the path"""


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """What the sensors report at one instant; a missing value is NaN. What a machine lacks keeps its default.

    A value with an age above 1 s is missing, and so is one of the future; up to 0.05 s of it count as now.
    """

    time: Seconds
    """of the sample"""
    tractor_x: Metres
    """east of the tractor antenna"""
    tractor_y: Metres
    """north of the tractor antenna"""
    trailer_x: Metres
    """east of the trailer antenna"""
    trailer_y: Metres
    """north of the trailer antenna"""
    hitch_angle: Radians
    """beta, tractor yaw minus drawbar yaw"""
    speed: MetresPerSecond
    """of the wheels"""
    tractor_steering: Radians
    """delta_t, front wheels, left positive"""
    trailer_steering: Radians
    """delta_i, actuated joint between drawbar and trailer"""
    tractor_fix_deviation: Metres = math.nan
    """standard deviation of each coordinate of the tractor's fix; 0 or less: the fix is missing"""
    trailer_fix_deviation: Metres = math.nan
    """standard deviation of each coordinate of the trailer's fix; 0 or less: the fix is missing"""
    tractor_roll: Radians = math.nan
    """right side down positive"""
    tractor_pitch: Radians = math.nan
    """nose up positive"""
    tractor_yaw: Radians = math.nan
    """direction in which the tractor faces, from east, by a receiver with two antennas on it, -2 pi to 2 pi"""
    tractor_yaw_rate: RadiansPerSecond = math.nan
    """counter-clockwise positive"""
    trailer_roll: Radians = math.nan
    """right side down positive"""
    trailer_pitch: Radians = math.nan
    """nose up positive"""
    trailer_yaw_rate: RadiansPerSecond = math.nan
    """counter-clockwise positive; recorded only, nothing uses it"""
    tractor_fix_age: Seconds = 0.0
    """of the tractor's position at the time of the sample; 0: not reported, `sensors.fixes.age` is used"""
    trailer_fix_age: Seconds = 0.0
    """of the trailer's position at the time of the sample; 0: not reported, `sensors.fixes.age` is used"""
    hitch_angle_age: Seconds = 0.0
    """of the hitch angle at the time of the sample"""
    speed_age: Seconds = 0.0
    """of the speed at the time of the sample"""
    tractor_steering_age: Seconds = 0.0
    """of the tractor's steering angle at the time of the sample"""
    trailer_steering_age: Seconds = 0.0
    """of the trailer's steering angle at the time of the sample"""
    tractor_attitude_age: Seconds = 0.0
    """of the tractor's roll, pitch, yaw and yaw rate at the time of the sample"""
    trailer_attitude_age: Seconds = 0.0
    """of the trailer's roll, pitch and yaw rate at the time of the sample"""
    tractor_fix_quality: FixQuality = FixQuality.UNKNOWN
    trailer_fix_quality: FixQuality = FixQuality.UNKNOWN


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """Position on the ground and continuous yaw of one body's point."""

    x: Metres
    y: Metres
    yaw: Radians


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """Estimated poses, joint angles, speed and slip factors at one time."""

    time: Seconds
    """of the measurement"""
    tractor: Pose
    """of the middle of its rear axle, on the ground"""
    trailer: Pose
    """of its tracked point, on the ground"""
    hitch_angle: Radians
    """beta"""
    speed: MetresPerSecond
    """v, of the wheels"""
    tractor_steering: Radians
    """delta_t"""
    trailer_steering: Radians
    """delta_i"""
    longitudinal_slip: Ratio
    """mu"""
    tractor_slip: Ratio
    """kappa, factor on the tractor's steering angle"""
    trailer_slip: Ratio
    """eta, factor on the trailer's steering angle; 1 where the model has none"""
    steering_offset: Radians
    """b; 0 where the model has none"""
    tractor_crab: Radians
    """alpha_r, side-slip angle of the tractor's rear axle; 0 where the model has none"""
    trailer_crab: Radians
    """alpha_i, side-slip angle of the trailer's axle; 0 where the model has none"""
    slide_east: Radians = 0.0
    """side-slip angle to the east that a slope gives every axle; part of b and of both alpha"""
    slide_north: Radians = 0.0
    """the same to the north"""
    creep: Ratio = 0.0
    """side-slip angle per side acceleration in g that a curve gives every axle; part of b and of both alpha"""
    status: SolverStatus
    """of the estimator's solver"""
    tractor_fix: FixStatus = FixStatus.ACCEPTED
    trailer_fix: FixStatus = FixStatus.ACCEPTED


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """What the actuators are asked for."""

    time: Seconds
    """of the measurement that it answers"""
    tractor_steering: Radians
    """front wheels"""
    trailer_steering: Radians
    """actuated joint, in the actuator's own sign: opposite to the joint's where vehicle.joint_sign is -1"""
    speed: MetresPerSecond
    """of the wheels"""


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyDiagnostics:
    """How one body is, and how its command came about."""

    progress: Metres
    """of the body along the path"""
    lateral_error: Metres
    """of the body from the path, left positive"""
    nominal: Radians
    """steering of the plan"""
    ancillary: Radians
    """steering that answers the deviation from the plan"""
    margin: Ratio
    """1 at the centre of the tube, 0 on its boundary; NaN: none is declared"""
    saturated: bool
    """the steering ended at its bound"""
    solver: SolverStatus
    """of the body's controller"""
    fix: FixStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnostics:
    """Diagnostics of the last step."""

    tractor: BodyDiagnostics
    trailer: BodyDiagnostics
    speed: MetresPerSecond
    """commanded while the run goes on"""
    start_distance: Metres
    """of the tractor from where the run is to begin, before it begins; NaN: its position is missing"""
    unsolved: Seconds
    """for how long estimator and controllers have not all had a solution"""
    overdue: Seconds
    """what is left of the time by which samples came late"""
    status: Status
    """what drawbar_feedback returned, without the flags of a new command"""
    flags: Flag
    estimator: SolverStatus
    gate: GateVerdict
    guidance: GuidanceStatus
    missing: int
    """measured values that were infinite or beyond what their sensors can mean"""


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class BodyActuation:
    """Identified dynamics of one steering from command to angle; zero where none are identified."""

    dead_time: Seconds = 0.0
    """between a command and the first reaction"""
    dead_time_deviation: Seconds = 0.0
    """standard deviation"""
    lag: Seconds = 0.0
    """time constant"""
    lag_deviation: Seconds = 0.0
    """standard deviation"""
    rate: RadiansPerSecond = 0.0
    """fastest that it turns, the stated rate at most"""
    rate_deviation: RadiansPerSecond = 0.0
    """standard deviation"""


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Actuation:
    """Identified dynamics of steerings and errors of sensors, and what plans assume; zero where none are identified."""

    tractor: BodyActuation = BodyActuation()
    """front wheels"""
    trailer: BodyActuation = BodyActuation()
    """actuated joint"""
    dead_time: Seconds = 0.0
    """that plans assume, beside the lag of the body"""
    body_lag: Seconds = 0.0
    """by which the tractor turns later than its wheels stand: stated (`actuation.body_lag_per_speed`), by the ground's
    creep, and as the yaw-rate sensor identifies it; plans assume it"""
    body_lag_deviation: Seconds = 0.0
    """standard deviation of the part that the yaw-rate sensor identifies"""
    tractor_lag: Seconds = 0.0
    """that plans assume"""
    trailer_lag: Seconds = 0.0
    """that plans assume"""
    tractor_rate: RadiansPerSecond = 0.0
    """that plans assume"""
    trailer_rate: RadiansPerSecond = 0.0
    """that plans assume"""
    fix_latency: Seconds = 0.0
    """identified by the yaw-rate sensor, beyond the age that receivers or `sensors.fixes.age` state"""
    hitch_latency: Seconds = 0.0
    """of the hitch angle, identified by the ways of both antennas, beyond its reported age"""
    hitch_scale: Ratio = 0.0
    """identified scale error of the hitch sensor: true per measured angle, less 1"""
    joint_scale: Ratio = 0.0
    """identified scale error of the joint's sensor, by which its board follows commands as well"""
    tractor_roll_offset: Radians = 0.0
    """identified zero of the tractor's roll sensor, beyond the stated offset"""
    tractor_roll_deviation: Radians = 0.0
    """standard deviation"""
    trailer_roll_offset: Radians = 0.0
    """identified zero of the trailer's roll sensor, beyond the stated offset"""
    trailer_roll_deviation: Radians = 0.0
    """standard deviation"""
