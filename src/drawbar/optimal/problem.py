"""Optimal control and estimation problems as plain data."""

import math
from dataclasses import dataclass, field

from drawbar.errors import SolverError
from drawbar.vehicle.model import Model


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound:
    """lower <= variable <= upper at every stage; hard unless a penalty is given."""

    lower: float
    upper: float
    linear_penalty: float = math.inf
    """cost of a violation, per unit; infinite: the bound is hard"""
    quadratic_penalty: float = 0.0
    """cost of a violation, per unit squared (half of it, as in 1/2 q v²)"""

    def __post_init__(self) -> None:
        if not self.lower <= self.upper:
            raise SolverError(
                f"Bounds cross: lower {self.lower} is not below upper {self.upper}; exchange or widen them."
            )
        if not (self.linear_penalty > 0.0 and 0.0 <= self.quadratic_penalty < math.inf):
            raise SolverError(
                f"Penalties of a soft bound must be positive, got {self.linear_penalty} and {self.quadratic_penalty}."
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlProblem:
    """min over u of the sum over stages of ||h(x,u,p) - y||²_W from a given state, by multiple shooting.

    Weights are per output: `weights` (ny) on stages 0..N-1, `terminal_weights` (ny) on stage N, where outputs that
    depend on the input must weigh zero.
    """

    model: Model
    horizon: int
    """N, shooting intervals"""
    sample_time: float
    """s"""
    weights: tuple[float, ...]
    terminal_weights: tuple[float, ...]
    bounds: dict[str, Bound] = field(default_factory=dict)
    """by name of a state (stages 1..N) or input (stages 0..N-1)"""
    integration_steps: int = 1
    """Runge-Kutta steps per sample"""
    initial_weights: tuple[float, ...] = ()
    """none: the first state is given; else per state, on the distance of a free first state from what it should be"""

    def __post_init__(self) -> None:
        _check_time(self.horizon, self.sample_time, self.integration_steps)
        _check_weights("weights", self.weights, len(self.model.outputs))
        _check_weights("terminal_weights", self.terminal_weights, len(self.model.outputs))
        if self.initial_weights:
            _check_weights("initial_weights", self.initial_weights, len(self.model.states))
        _check_bounds(self.model, self.bounds, "state or input")


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimationProblem:
    """min over x_0, p, u of the arrival cost plus the sum of ||h(x,u,p) - y||²_H over a window.

    The model's parameters become states that are constant within the window (and drift between windows by their
    process noise). Rows of `prior_deviation` and `process_deviation` are the states, then the parameters.
    """

    model: Model
    horizon: int
    """N, sampling intervals in the window"""
    sample_time: float
    """s"""
    weights: tuple[float, ...]
    """diagonal of H, per output"""
    prior_deviation: tuple[float, ...]
    """standard deviation of the first prior, per state and parameter"""
    process_deviation: tuple[float, ...]
    """standard deviation of the process noise per sample, per state and parameter; zero is allowed"""
    common_deviation: tuple[float, ...] = ()
    """the same of one more noise that moves all states and parameters at once; empty: there is none"""
    bounds: dict[str, Bound] = field(default_factory=dict)
    """by name of a state, parameter or input"""
    integration_steps: int = 1

    def __post_init__(self) -> None:
        _check_time(self.horizon, self.sample_time, self.integration_steps)
        _check_weights("weights", self.weights, len(self.model.outputs))
        size = len(self.model.states) + len(self.model.parameters)
        _check_weights("prior_deviation", self.prior_deviation, size)
        _check_weights("process_deviation", self.process_deviation, size)
        _check_weights("common_deviation", self.common_deviation or (0.0,) * size, size)
        if not all(deviation > 0.0 for deviation in self.prior_deviation):
            raise SolverError(f"prior_deviation must be positive, got {self.prior_deviation}.")
        _check_bounds(self.model, self.bounds, "state, parameter or input")


def _check_time(horizon: int, sample_time: float, steps: int) -> None:
    if horizon < 2 or steps < 1:
        raise SolverError(f"Need a horizon of at least 2 stages and 1 integration step, got {horizon} and {steps}.")
    if not 0.0 < sample_time < math.inf:
        raise SolverError(f"The sample time must be positive and finite, got {sample_time} s.")


def _check_weights(name: str, values: tuple[float, ...], size: int) -> None:
    if len(values) != size:
        raise SolverError(f"{name} needs {size} values, got {len(values)}: {values}.")
    if not all(0.0 <= value < math.inf for value in values):
        raise SolverError(f"{name} must be finite and not negative, got {values}.")


def _check_bounds(model: Model, bounds: dict[str, Bound], allowed: str) -> None:
    kinds = (
        (model.states, model.inputs) if "parameter" not in allowed else (model.states, model.parameters, model.inputs)
    )
    names = [variable.name for kind in kinds for variable in kind]
    for name in bounds:
        if name not in names:
            raise SolverError(
                f"Bound on {name!r}, which is no {allowed} of {model.name!r}; there are {', '.join(names)}."
            )
