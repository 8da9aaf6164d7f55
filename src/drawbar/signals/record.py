"""The record of a step: all its signals, the truth of a simulation, and how long the solvers took."""

from dataclasses import dataclass, field
from functools import partial

from drawbar.signals.inner import BodySteering, Places, Plan
from drawbar.signals.public import Actuation, Command, Estimate, Measurement, Pose
from drawbar.signals.structs import as_struct
from drawbar.statuses import Flag, GateVerdict, Status


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """The truth, which only a simulation has."""

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
class SolveTimes:
    """Wall-clock time of one solver's two phases, s; NaN where a body has no solver of its own."""

    prepare: float
    feedback: float


@partial(as_struct, keeps=True)
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
    """remarks on the command"""
    actuation: Actuation = field(default_factory=Actuation)
