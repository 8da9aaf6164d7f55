"""The signals that flow through one control step: frozen, timestamped, SI units, ENU, counter-clockwise.

Each signal is declared here alone: `exchange.py` prints the C structures, enumerations and texts from these
declarations (`drawbar_signals.h`, `signals.h`) and moves values between the two languages.

Measured positions are those of the two antennas. Estimates, plans and the truth speak of one point on the ground for
each body: the middle of the tractor's rear axle, and the trailer's tracked point, `vehicle.trailer_antenna` ahead of
its axle. Yaw is continuous along a run. A missing value is NaN.
"""

import math
from dataclasses import dataclass, field
from enum import IntEnum, IntFlag
from typing import Annotated, Self

import numpy as np

from drawbar.geometry import Floats
from drawbar.structs import as_struct


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """What a number measures."""

    unit: str
    limit: float = math.inf
    """largest magnitude that a sensor can have meant; a measured value beyond it is taken for missing"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Array:
    """The shape of an array in C: of fixed size, or rows behind a pointer."""

    columns: int
    """numbers in a row; 0: the rows are single numbers"""
    rows: str = ""
    """how many rows the pointer leads to; empty: the array is one row within the structure"""
    counted: bool = False
    """the number of rows is a member of the structure, of that name"""


Seconds = Annotated[float, Quantity(unit="s")]
Metres = Annotated[float, Quantity(unit="m", limit=1e7)]  # beyond 1e7 m a double holds too few digits
Radians = Annotated[float, Quantity(unit="rad", limit=2.0 * math.pi)]
MetresPerSecond = Annotated[float, Quantity(unit="m/s", limit=50.0)]
RadiansPerSecond = Annotated[float, Quantity(unit="rad/s", limit=50.0)]
Ratio = Annotated[float, Quantity(unit="1")]


class Status(IntEnum):
    """What became of a control step; each status carries its text. Below REFUSED it is a set of flags (Flag)."""

    text: str

    def __new__(cls, value: int, text: str = "") -> Self:
        """Make a status of its number and its text."""
        status = int.__new__(cls, value)
        status._value_ = value
        status.text = text
        return status

    OK = 0, "done; of a step: with a new command"

    REFUSED = 64, "last command repeated: the new one is not finite or exceeds its limits"
    TIME = 65, "last command repeated: the time stamp is not finite or does not increase"
    POSITION = 66, "standing: the run cannot begin, an antenna's position is missing"
    START = 67, "standing: the run cannot begin, the tractor is too far from where it is to begin on the path"

    FINISHED = 128, "stopped: the tractor has reached the end of the path"
    OFF_COURSE = 129, "stopped: the tractor is too far from the path"
    BLIND = 130, "stopped: neither antenna has had a valid fix for too long"
    GUIDANCE = 131, "stopped: the estimate is not finite, or no turns lead back onto the path"
    GAP = 132, "stopped: samples were left out for longer than a command may be repeated"
    STOPPED = 133, "stopped: no command could be given for longer than one may be repeated"
    UNSOLVED = 134, "stopped: estimator or controllers have had no solution for too long"
    OVERDUE = 135, "stopped: samples came late for too long"
    COARSE = 140, "stopped: positions have been coarse for too long"
    OSCILLATION = 141, "stopped: errors or steering swing from side to side"
    BACKWARDS = 142, "stopped: both antennas move backwards: they are swapped, or the vehicle is driven in reverse"
    STEERING = 143, "stopped: a steering does not follow its commands: sensor or actuator fails, or somebody steers"
    HITCH = 144, "stopped: the hitch angle contradicts the motion of both bodies"

    NULL = 256, "wrong call: a pointer is NULL"
    NOT_INITIALISED = 257, "wrong call: drawbar_init has not been called on this state"
    NO_PATH = 258, "wrong call: drawbar_set_path has not been called, or not with success"
    ORDER = 259, "wrong call: feedback and prepare do not alternate"
    PATH = 260, "wrong call: the path's table is not a smooth path"
    RANGE = 261, "wrong call: a number is beyond what is allowed"
    NO_RUN = 262, "wrong call: no run has begun, or it has ended"

    @property
    def is_new_command(self) -> bool:
        """Whether the step made a new command."""
        return self < Status.REFUSED

    @property
    def has_ended(self) -> bool:
        """Whether the run has ended; the vehicle is stopped."""
        return Status.FINISHED <= self < Status.NULL


class Flag(IntFlag):
    """What there is to say of a step that made a new command; each flag carries its text."""

    text: str

    def __new__(cls, value: int, text: str = "") -> Self:
        """Make a flag of its number and its text; a set of flags has none."""
        flag = int.__new__(cls, value)
        flag._value_ = value
        flag.text = text
        return flag

    MEASUREMENT = 1, "a measured value was infinite or beyond what its sensor can mean, and was taken for missing"
    LATE = 2, "one or more samples were left out"
    LIMITED = 4, "steering clamped where the valve is already fully open; the motion is unchanged"
    SOLVER = 8, "a solver failed; the estimate or the plan is its own prediction"
    SLOWED = 16, "the vehicle is driven slower than the set speed, until estimates and plans are sound again"
    RELEASED = 32, "not engaged: the command repeats the steering as it is, with speed zero"


class FixQuality(IntEnum):
    """How a receiver found a position."""

    UNKNOWN = 0
    """the receiver does not say"""
    NONE = 1
    SINGLE = 2
    """without corrections"""
    DIFFERENTIAL = 3
    FLOAT = 4
    """RTK, ambiguities not resolved"""
    FIXED = 5
    """RTK, ambiguities resolved"""


class SolverStatus(IntEnum):
    """Outcome of a solver call; the C runtime returns the same numbers."""

    SOLVED = 0
    MAXIMUM_ITERATIONS = 1
    INFEASIBLE = 2
    NOT_FINITE = 3
    CHECK_FAILED = 4
    BAD_INPUT = 5


class FixStatus(IntEnum):
    """What an estimator made of one antenna's position fix."""

    ACCEPTED = 0
    MISSING = 1
    """the receiver reported none"""
    STALE = 2
    """the receiver repeated an old one while the vehicle moved"""
    REJECTED = 3
    """too far from the predicted position, or contradicted by the other antenna"""


class GateVerdict(IntEnum):
    """What the gate made of a command."""

    PASSED = 0
    LIMITED = 1
    """steering clamped where the valve is already fully open; the motion is unchanged"""
    REPEATED = 2
    """refused: the last one that passed was repeated"""
    STOPPED = 3
    """refused, and there was none to repeat, or none new enough: speed zero, steering held"""


class Supervision(IntEnum):
    """Whether a run may go on."""

    ON_COURSE = 0
    OFF_COURSE = 1
    """the tractor is too far from the path, or its distance is not known"""
    BLIND = 2
    """neither antenna has had a fix that was believed for too long"""


class GuidanceStatus(IntEnum):
    """How guidance went."""

    FINE = 0
    FAR_FROM_START = 1
    """the tractor is too far from where the run is to begin, or its position is missing"""
    POSE_NOT_FINITE = 2
    """a body's position or yaw is not finite"""
    SPEED_NOT_FINITE = 3
    NO_WAY = 4
    """the tractor faces away and no turns lead onto the path"""


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """What the sensors report at one instant; a missing value is NaN. What a machine lacks keeps its default."""

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
    """standard deviation of each coordinate of the tractor's fix"""
    trailer_fix_deviation: Metres = math.nan
    """standard deviation of each coordinate of the trailer's fix"""
    tractor_roll: Radians = math.nan
    """right side down positive"""
    tractor_pitch: Radians = math.nan
    """nose up positive"""
    tractor_yaw_rate: RadiansPerSecond = math.nan
    """counter-clockwise positive"""
    trailer_roll: Radians = math.nan
    """right side down positive"""
    trailer_pitch: Radians = math.nan
    """nose up positive"""
    trailer_yaw_rate: RadiansPerSecond = math.nan
    """counter-clockwise positive"""
    tractor_fix_age: Seconds = 0.0
    """of the tractor's position at the time of the sample"""
    trailer_fix_age: Seconds = 0.0
    """of the trailer's position at the time of the sample"""
    hitch_angle_age: Seconds = 0.0
    """of the hitch angle at the time of the sample"""
    speed_age: Seconds = 0.0
    """of the speed at the time of the sample"""
    tractor_steering_age: Seconds = 0.0
    """of the tractor's steering angle at the time of the sample"""
    trailer_steering_age: Seconds = 0.0
    """of the trailer's steering angle at the time of the sample"""
    tractor_attitude_age: Seconds = 0.0
    """of the tractor's roll, pitch and yaw rate at the time of the sample"""
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
class Estimate:
    """What the estimator believes now."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyPlace:
    """Where one body is beside the path."""

    progress: Metres
    """arc length of the closest point"""
    lateral_error: Metres
    """of the body from the path, left positive"""
    closest: Annotated[Floats, Array(columns=4)]
    """the path at the closest point: x (m), y (m), yaw (rad, on any branch), curvature (1/m)"""


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyReference(BodyPlace):
    """The path as one body's controller sees it: the closest point and one sample for each stage."""

    samples: Annotated[Floats, Array(columns=4, rows="N + 1")]
    """x (m), y (m), yaw (rad, on the branch of the estimate), curvature (1/m) of each stage"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """References of both bodies at one instant, as controllers are given them."""

    time: float
    """s"""
    tractor: BodyReference
    trailer: BodyReference


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Places:
    """Where both bodies are beside the path at one instant: references without their samples, which the path tells."""

    time: float
    """s"""
    tractor: BodyPlace
    trailer: BodyPlace


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class BodyPlan:
    """One nominal controller's answer."""

    steering: Radians
    """nominal steering to apply now"""
    poses: Annotated[Floats, Array(columns=3, rows="N + 1")]
    """predicted x (m), y (m), yaw (rad) of the body's point"""
    steerings: Annotated[Floats, Array(columns=0, rows="N")]
    """planned steering, rad"""
    deviation: Annotated[Floats, Array(columns=0, rows="deviations", counted=True)] = field(
        default_factory=lambda: np.zeros(0)
    )
    """x^ - x- in the error coordinates of this body's controller; empty where there is no nominal state"""
    status: SolverStatus


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """The nominal plans of both bodies at one instant."""

    time: float
    """s"""
    tractor: BodyPlan
    trailer: BodyPlan


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


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """What only a simulation knows."""

    time: float
    """s"""
    tractor: Pose
    trailer: Pose
    speed: float
    """wheel speed, m/s"""
    tractor_steering: float
    """rad"""
    trailer_steering: float
    """rad"""
    longitudinal_slip: float
    """mu"""
    tractor_slip: float
    """kappa"""
    steering_offset: float
    """b, rad"""
    tractor_crab: float
    """alpha_r, rad"""
    trailer_crab: float
    """alpha_i, rad"""
    tractor_roll: float = 0.0
    """right side down positive, rad"""
    tractor_pitch: float = 0.0
    """nose up positive, rad"""
    trailer_roll: float = 0.0
    """right side down positive, rad"""
    trailer_pitch: float = 0.0
    """nose up positive, rad"""
    tractor_height: float = 0.0
    """of the tractor's point on the ground, m"""
    trailer_height: float = 0.0
    """of the trailer's point on the ground, m"""


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class BodySteering:
    """How one steering command came about: nominal plus ancillary, then clipped."""

    nominal: Radians
    """of the plan"""
    ancillary: Radians
    """K (x^ - x-)"""
    command: Radians
    """their sum within the bound"""
    margin: Ratio = math.nan
    """how far inside its tube the body is: 1 at its centre, 0 on its boundary, negative outside; NaN: none declared"""
    saturated: bool
    """the sum was beyond the bound"""


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
    """What there is to say of the last step."""

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
    """What one steering makes of its commands, as far as its angles show; zero where nobody looks."""

    dead_time: Seconds = 0.0
    """between a command and the first reaction"""
    dead_time_deviation: Seconds = 0.0
    """standard deviation"""
    lag: Seconds = 0.0
    """time constant"""
    lag_deviation: Seconds = 0.0
    """standard deviation"""


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Actuation:
    """What is known of both steerings, and what is planned with; zero where nobody looks."""

    tractor: BodyActuation = BodyActuation()
    """front wheels"""
    trailer: BodyActuation = BodyActuation()
    """actuated joint"""
    dead_time: Seconds = 0.0
    """for which is planned, beside the lag of the body (`actuation.body_lag_per_speed`)"""
    tractor_lag: Seconds = 0.0
    """for which is planned"""
    trailer_lag: Seconds = 0.0
    """for which is planned"""


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class SolveTimes:
    """Wall-clock time of one solver's two phases, s; NaN where a body has no solver of its own."""

    prepare: float
    feedback: float


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class StepRecord:
    """Everything one control step took in, decided and put out."""

    step: int
    measurement: Measurement
    estimate: Estimate
    reference: Places
    plan: Plan
    tractor_steering: BodySteering
    trailer_steering: BodySteering
    command: Command
    truth: Truth | None
    """None on a real machine"""
    estimator_times: SolveTimes
    tractor_times: SolveTimes
    trailer_times: SolveTimes
    solver_failures: int
    """estimate and plans of this step that did not end in SOLVED; a centralised solver makes the plans of both"""
    gate: GateVerdict
    """what the gate made of this step's command"""
    status: Status
    """OK: the command is a new one"""
    flags: Flag
    """what there is to say of the command"""
    actuation: Actuation = Actuation()
