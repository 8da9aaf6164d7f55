"""The eight problems that drawbar solves, with data that make them work: beside the path, noisy, bounds in the way."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem, ControlSolver, EstimationProblem, EstimationSolver
from drawbar.vehicle.articulated import (
    articulated,
    articulated_tracking,
    articulated_tractor,
    articulated_trailer,
)
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.model import Model, Variable
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle, tricycle_tractor, tricycle_trailer

N, SAMPLE = 12, 0.2
VEHICLE = VehicleParameters()
SIGMA = np.array([0.03, 0.03, 0.03, 0.03, 0.0175, 0.1, 0.0175, 0.0175])


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A problem with the data of one solve."""

    problem: ControlProblem | EstimationProblem
    initial: Floats
    """(nx,) given state, or the prior of an estimator"""
    p: Floats
    """(N+1, np) known parameters; empty for an estimator"""
    y: Floats
    """(N+1, ny)"""

    def solver(self) -> ControlSolver | EstimationSolver:
        """Return a solver that holds the data and starts at the initial state throughout."""
        solver = self._estimator() if isinstance(self.problem, EstimationProblem) else self._controller()
        solver.y[:] = self.y
        return solver

    def _estimator(self) -> EstimationSolver:
        assert isinstance(self.problem, EstimationProblem)
        return EstimationSolver(self.problem, self.initial)

    def _controller(self) -> ControlSolver:
        assert isinstance(self.problem, ControlProblem)
        solver = ControlSolver(self.problem)
        solver.p[:], solver.initial[:], solver.x[:] = self.p, self.initial, self.initial
        return solver


def named_values(declared: tuple[Variable, ...], values: Any) -> dict[str, float]:
    """Return values by name of the variables whose order they have."""
    return {variable.name: float(value) for variable, value in zip(declared, values, strict=True)}


def _control(model: Model, weights: Any, terminal: Any, *limits: float, **data: Floats) -> Case:
    problem = ControlProblem(
        model=model,
        horizon=N,
        sample_time=SAMPLE,
        weights=named_values(model.outputs, weights),
        terminal_weights=named_values(model.outputs, terminal),
        bounds={v.name: Bound(lower=-limit, upper=limit) for v, limit in zip(model.inputs, limits, strict=True)},
    )
    return Case(problem=problem, **data)


def _tricycle(declare: Callable[..., Model], parameters: tuple[float, ...], start: Any, limit: float) -> Case:
    ahead = start[0] + 0.4 + SAMPLE * np.arange(N + 1)
    y = np.column_stack([ahead, 0.05 * np.sin(ahead), np.zeros(N + 1)])
    p = np.tile(parameters, (N + 1, 1))
    return _control(declare(VEHICLE), (1.0, 1.0, 1.0), (10.0, 10.0, 0.0), limit, initial=np.array(start), p=p, y=y)


def _articulated_tractor() -> Case:
    own = np.tile((0.95, 0.92, 0.01, 0.02, 1.0), (N + 1, 1))
    along = SAMPLE * np.arange(N + 1)
    p = np.column_stack([own, along, 0.02 * along**2, 0.04 * along])
    data = {"initial": np.array([0.1, 0.4, 0.05, 0.1]), "p": p, "y": np.full((N + 1, 4), 0.01)}
    return _control(articulated_tractor(VEHICLE), (10.0, 1.0, 0.1, 5.0), (10.0, 1.0, 0.0, 0.0), 0.15, **data)


def _articulated_trailer() -> Case:
    own = np.tile((0.95, 0.02, 0.01, 1.0, 0.04), (N + 1, 1))
    along = SAMPLE * np.arange(N + 1)
    tractor = np.column_stack([0.95 * along, 0.02 * along**2, 0.04 * along])
    reference = np.column_stack([0.95 * along - 2.15, np.full(N + 1, -0.05), np.zeros(N + 1)])
    p = np.column_stack([own, tractor, reference])
    data = {"initial": np.array([0.05, -0.05]), "p": p, "y": np.zeros((N + 1, 3))}
    return _control(articulated_trailer(VEHICLE), (20.0, 0.02, 0.5), (20.0, 0.0, 0.0), 0.12, **data)


def _tricycle_centralised() -> Case:
    ahead = 0.4 + SAMPLE * np.arange(N + 1)
    paths = [column for along in (ahead, ahead - 2.2) for column in (along, 0.05 * np.sin(along))]
    y = np.column_stack([*paths, np.zeros((N + 1, 4))])
    data = {
        "initial": np.array([0.0, 0.5, 0.1, -2.2, 0.4, 0.1]),
        "p": np.tile((0.95, 0.92, 0.9, -0.05, 1.0), (N + 1, 1)),
        "y": y,
    }
    weights = (1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0)
    terminal = (10.0, 10.0, 10.0, 10.0, 0.0, 0.0, 0.0, 0.0)
    return _control(tricycle(VEHICLE), weights, terminal, 0.3, 0.2, **data)


def _articulated_centralised() -> Case:
    own = np.tile((0.95, 0.92, 0.01, 0.01, 1.0, 0.02), (N + 1, 1))
    along = SAMPLE * np.arange(N + 1)
    tractor = np.column_stack([along, 0.02 * along**2, 0.04 * along])
    trailer = np.column_stack([along - 2.15, np.full(N + 1, -0.05), np.zeros(N + 1)])
    data = {
        "initial": np.array([0.1, 0.4, 0.05, 0.0, 0.1, -0.05]),
        "p": np.column_stack([own, tractor, trailer]),
        "y": np.full((N + 1, 7), 0.01),
    }
    weights = (10.0, 1.0, 0.1, 5.0, 20.0, 0.02, 0.5)
    terminal = (10.0, 1.0, 0.0, 0.0, 20.0, 0.0, 0.0)
    return _control(articulated_tracking(VEHICLE), weights, terminal, 0.15, 0.12, **data)


def simulated(model: Model, x: Floats, u: Floats, p: Floats) -> Floats:
    """Return the outputs (N+1, ny) of a run with inputs u (N, nu); the last row repeats the last input."""
    step = ca.Function("F", [model.x, model.u, model.p], [integrate(model, SAMPLE)])
    output = ca.Function("h", [model.x, model.u, model.p], [model.numeric().output])
    rows = []
    for k in range(len(u) + 1):
        rows.append(np.array(output(x, u[min(k, len(u) - 1)], p)).ravel())
        x = np.array(step(x, u[min(k, len(u) - 1)], p)).ravel()
    return np.array(rows)


def _measured(y: Floats, seed: int) -> Floats:
    """Return the measurements with noise on the eight sensors and gaps in some."""
    rng = np.random.default_rng(seed)
    y = y.copy()
    y[:, :8] += SIGMA * rng.normal(size=(len(y), 8))
    y[3:6, :4] = np.nan
    gaps = rng.random(y.shape) < 0.05
    gaps[:, 1:4:2] = gaps[:, 0:3:2]  # an antenna reports both coordinates or none
    y[gaps] = np.nan
    return y


def _estimator(model: Model, extra: tuple[float, ...], prior: Any, deviation: Any, y: Floats, **bounds: Bound) -> Case:
    estimated = (*model.states, *model.parameters)
    problem = EstimationProblem(
        model=model,
        horizon=N,
        sample_time=SAMPLE,
        weights=named_values(model.outputs, 1.0 / np.array([*SIGMA, *extra]) ** 2),
        prior_deviation=named_values(estimated, deviation),
        process_deviation=named_values(estimated, 0.1 * np.array(deviation)),
        bounds=bounds,
    )
    return Case(problem=problem, initial=np.array(prior), p=np.zeros((N + 1, 0)), y=y)


def _tricycle_estimator() -> Case:
    model = tricycle(VEHICLE)
    u = np.column_stack([0.2 * np.sin(0.4 * np.arange(N)), np.full(N, 0.05)])
    start, p = np.array([0.0, 0.0, 0.2, -2.2, -0.3, 0.1]), np.array([0.97, 0.9, 0.95, 0.08, 1.0])
    y = _measured(simulated(model, start, u, p), 31)
    prior = (0.05, -0.05, 0.3, -2.2, -0.2, 0.2, 0.9, 0.9, 0.9, 0.0, 0.9)
    deviation = (0.1, 0.1, 0.3, 0.1, 0.1, 0.3, 0.1, 0.1, 0.1, 0.1, 0.2)
    slips = ("longitudinal_slip", "tractor_slip", "trailer_slip")
    bounds = {name: Bound(lower=0.25, upper=0.88) for name in slips}
    return _estimator(model, (), prior, deviation, y, **bounds)


def _articulated_estimator() -> Case:
    model = articulated(VEHICLE)
    u = np.column_stack([0.1 * np.sin(0.4 * np.arange(N)), 0.05 * np.cos(0.5 * np.arange(N))])
    start, p = np.array([0.0, 0.0, 0.2, 0.1, 0.1, -0.05]), np.array([0.97, 0.9, 0.01, 0.02, 1.0, -0.01])
    y = _measured(simulated(model, start, u, p), 32)
    y[:, 8:] = 0.0
    prior = (0.05, -0.05, 0.3, 0.0, 0.05, 0.0, 0.9, 0.9, 0.0, 0.0, 0.9, 0.0)
    deviation = (0.1, 0.1, 0.3, 0.3, 0.05, 0.05, 0.1, 0.1, 0.02, 0.02, 0.2, 0.02)
    bounds = {
        "longitudinal_slip": Bound(lower=0.25, upper=0.93),
        "trailer_crab": Bound(lower=-0.005, upper=0.15),
    }
    return _estimator(model, (0.3, 0.3), prior, deviation, y, **bounds)


CASES: dict[str, Callable[[], Case]] = {
    "tricycle_tractor": lambda: _tricycle(tricycle_tractor, (0.95, 0.92, 1.0), (0.0, 0.5, 0.1), 0.3),
    "tricycle_trailer": lambda: _tricycle(tricycle_trailer, (0.95, 0.92, -0.05, 1.0, 0.05), (-2.2, 0.4, 0.1), 0.2),
    "articulated_tractor": _articulated_tractor,
    "articulated_trailer": _articulated_trailer,
    "tricycle_centralised": _tricycle_centralised,
    "articulated_centralised": _articulated_centralised,
    "tricycle_estimator": _tricycle_estimator,
    "articulated_estimator": _articulated_estimator,
}


@pytest.fixture(scope="session", params=CASES)
def case(request: pytest.FixtureRequest) -> Case:
    """Each of the eight problems in turn."""
    return CASES[request.param]()


@pytest.fixture(scope="session")
def named() -> Callable[[str], Case]:
    """Return a problem by name."""
    return lambda name: CASES[name]()


@pytest.fixture(scope="session")
def long_run() -> tuple[Case, Floats, Floats]:
    """Return the articulated estimator without bounds or process noise, the readings of a minute, and the truth."""
    case = _articulated_estimator()
    rng = np.random.default_rng(33)
    count = 300
    u = np.column_stack([0.15 * np.cos(0.3 * np.arange(count)), 0.05 * np.cos(0.2 * np.arange(count))])
    start, p = np.array([0.0, 0.0, 0.2, 0.1, 0.1, -0.05]), np.array([0.95, 0.92, 0.01, 0.01, 1.0, -0.01])
    true = simulated(case.problem.model, start, u, p)
    y = true.copy()
    y[:, :8] += SIGMA * rng.normal(size=(count + 1, 8))
    y[:, 8:] = 0.0
    y[100:115, :4] = np.nan
    assert isinstance(case.problem, EstimationProblem)
    problem = replace(case.problem, bounds={}, process_deviation=dict.fromkeys(case.problem.prior_deviation, 0.0))
    return replace(case, problem=problem), y, true
