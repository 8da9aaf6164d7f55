"""The signals that flow through one control step: frozen, timestamped, SI units, ENU, counter-clockwise.

Positions are those of the two antennas; yaw is continuous along a run. A missing value is NaN.
"""

import math
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from drawbar.geometry import Floats


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
    """further from where it was expected than it can be"""


class GateVerdict(IntEnum):
    """What the gate made of a command."""

    PASSED = 0
    LIMITED = 1
    """its steering was brought nearer to where the wheels are; no actuator can tell"""
    REPEATED = 2
    """refused: the last one that passed was repeated"""
    STOPPED = 3
    """refused, and there was none to repeat, or none new enough: speed zero, steering held"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """What the sensors report at one instant; a missing value is NaN."""

    time: float
    """s"""
    tractor_x: float
    """east of the tractor antenna, m"""
    tractor_y: float
    """north of the tractor antenna, m"""
    trailer_x: float
    """east of the trailer antenna, m"""
    trailer_y: float
    """north of the trailer antenna, m"""
    hitch_angle: float
    """beta, tractor yaw minus drawbar yaw, rad"""
    speed: float
    """wheel speed, m/s"""
    tractor_steering: float
    """delta_t, front wheels, left positive, rad"""
    trailer_steering: float
    """delta_i, actuated joint between drawbar and trailer, rad"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """Position (m) and continuous yaw (rad) of one body's antenna."""

    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """What the estimator believes now."""

    time: float
    """s"""
    tractor: Pose
    trailer: Pose
    hitch_angle: float
    """beta, rad"""
    speed: float
    """v, wheel speed, m/s"""
    tractor_steering: float
    """delta_t, rad"""
    trailer_steering: float
    """delta_i, rad"""
    longitudinal_slip: float
    """mu"""
    tractor_slip: float
    """kappa, factor on the tractor's steering angle"""
    trailer_slip: float
    """eta, factor on the trailer's steering angle (1 where the model has none)"""
    steering_offset: float
    """b, rad (0 where the model has none)"""
    tractor_crab: float
    """alpha_r, side-slip angle of the tractor's rear axle, rad (0 where the model has none)"""
    trailer_crab: float
    """alpha_i, side-slip angle of the trailer's axle, rad (0 where the model has none)"""
    status: SolverStatus
    tractor_fix: FixStatus = FixStatus.ACCEPTED
    trailer_fix: FixStatus = FixStatus.ACCEPTED


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyReference:
    """The path as one body's controller sees it: the closest point and one sample for each stage."""

    progress: float
    """arc length of the closest point, m"""
    lateral_error: float
    """signed distance of the body from the path, left positive, m"""
    closest: Floats
    """(4,): the path at the closest point: x (m), y (m), yaw (rad, on any branch), curvature (1/m)"""
    samples: Floats
    """(N+1, 4): x (m), y (m), yaw (rad, on the branch of the estimate), curvature (1/m)"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """References of both bodies at one instant."""

    time: float
    """s"""
    tractor: BodyReference
    trailer: BodyReference


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyPlan:
    """One nominal controller's answer."""

    steering: float
    """nominal steering to apply now, rad"""
    poses: Floats
    """(N+1, 3): predicted x (m), y (m), yaw (rad) of the antenna"""
    steerings: Floats
    """(N,): planned steering, rad"""
    deviation: Floats = field(default_factory=lambda: np.zeros(0))
    """x̂ - x̄ in the error coordinates of this body's controller; empty where it holds the vehicle to no nominal state"""
    status: SolverStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """The nominal plans of both bodies at one instant."""

    time: float
    """s"""
    tractor: BodyPlan
    trailer: BodyPlan


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """What the actuators are asked for."""

    time: float
    """s"""
    tractor_steering: float
    """rad"""
    trailer_steering: float
    """rad"""
    speed: float
    """m/s"""


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


@dataclass(frozen=True, slots=True, kw_only=True)
class BodySteering:
    """How one steering command came about: nominal plus ancillary, then clipped."""

    nominal: float
    """rad"""
    ancillary: float
    """K (x - x̄), rad"""
    command: float
    """after the bound, rad"""
    saturated: bool
    margin: float = math.nan
    """how far inside its tube the body is: 1 at its centre, 0 on its boundary, negative outside; NaN: none declared"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SolveTimes:
    """Wall-clock time of one solver's two phases, s; NaN where a body has no solver of its own."""

    prepare: float
    feedback: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StepRecord:
    """Everything one control step took in, decided and put out."""

    step: int
    measurement: Measurement
    estimate: Estimate
    reference: Reference
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
