"""Rotate, shift and mirror the world: a sequence of solver calls follows, also across yaw ±180°."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.optimal import EstimationProblem
from drawbar.signals import SolverStatus
from drawbar.vehicle.model import Variable

CALLS = 12


def moved(group: tuple[Variable, ...], values: Floats, angle: float, shift: Floats) -> Floats:
    """Rotate and shift columns of positions (neighbouring x and y) and turn columns of yaw."""
    result, (c, s) = values.copy(), (np.cos(angle), np.sin(angle))
    for i, v in enumerate(group):
        if v.name.endswith("yaw"):
            result[..., i] += angle
        if v.name.endswith("x") and v.unit == "m":
            result[..., i : i + 2] = values[..., i : i + 2] @ np.array([[c, s], [-s, c]]) + shift
    return result


def mirrored(group: tuple[Variable, ...], values: Floats) -> Floats:
    """Flip the y axis."""
    odd = [v.unit.startswith("rad") or v.name.endswith(("y", "lateral_error", "coupling")) for v in group]
    return np.where(odd, -values, values)


def run(case: Any, change: Callable[[tuple[Variable, ...], Floats], Floats]) -> tuple[Floats, Floats]:
    """Return every x and u of a sequence of calls in the changed world."""
    model, estimation = case.problem.model, isinstance(case.problem, EstimationProblem)
    states = (*model.states, *model.parameters) if estimation else model.states
    solver = case.solver()
    solver.x[:], solver.y[:] = change(states, solver.x), change(model.outputs, case.y)
    if estimation:
        solver.workspace.write({"prior": change(states, solver.prior)})
        solver.workspace.array("window.newest")[:] = case.problem.horizon
    else:
        solver.initial[:], solver.p[:] = change(states, case.initial), change(model.parameters, case.p)
    if change is not unchanged and (change(model.inputs, np.ones(len(model.inputs))) < 0).all():
        flip_bounds(solver)
    xs, us = [], []
    for _ in range(CALLS):
        solver.prepare()
        assert solver.feedback() == SolverStatus.SOLVED
        xs.append(solver.x.copy())
        us.append(solver.u.copy())
        if estimation:
            assert solver.slide() == SolverStatus.SOLVED
        else:
            solver.initial[:] = solver.x[1]
            solver.shift()
    return np.array(xs), np.array(us)


def unchanged(_: tuple[Variable, ...], values: Floats) -> Floats:
    return values


def flip_bounds(solver: Any) -> None:
    """Mirror the one bound that is not symmetric: of the trailer's crab angle."""
    if "trailer_crab" in solver.lower:
        lower, upper = solver.lower["trailer_crab"], solver.upper["trailer_crab"]
        lower[:], upper[:] = -upper, -lower


@pytest.mark.parametrize("angle", [0.4, 3.1, -2.0])
def test_solution_of_a_turned_and_shifted_problem_is_turned_and_shifted(case: Any, angle: float) -> None:
    shift = np.array([120.0, -45.0])
    model, estimation = case.problem.model, isinstance(case.problem, EstimationProblem)
    states = (*model.states, *model.parameters) if estimation else model.states
    x, u = run(case, unchanged)
    there_x, there_u = run(case, lambda group, values: moved(group, values, angle, shift))
    np.testing.assert_allclose(there_x, moved(states, x, angle, shift), rtol=0, atol=1e-9)
    np.testing.assert_allclose(there_u, u, rtol=0, atol=1e-9)


def test_solution_of_a_mirrored_problem_is_mirrored(case: Any) -> None:
    model, estimation = case.problem.model, isinstance(case.problem, EstimationProblem)
    states = (*model.states, *model.parameters) if estimation else model.states
    x, u = run(case, unchanged)
    there_x, there_u = run(case, mirrored)
    np.testing.assert_allclose(there_x, mirrored(states, x), rtol=0, atol=1e-9)
    np.testing.assert_allclose(there_u, mirrored(model.inputs, u), rtol=0, atol=1e-9)
