"""A control problem that chooses its first state, and the state that follows from its first input."""

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar.errors import SolverError
from drawbar.optimal import ControlProblem, ControlSolver
from drawbar.signals import SolverStatus


def freed(case: Any, weight: float) -> Any:
    """Return the case with its first state free."""
    weights = {state.name: weight for state in case.problem.model.states}
    return replace(case, problem=replace(case.problem, initial_weights=weights))


def settled(solver: ControlSolver) -> ControlSolver:
    for _ in range(12):
        solver.prepare()
        assert solver.feedback() == SolverStatus.SOLVED
    return solver


def cost(solver: ControlSolver, case: Any) -> float:
    """Return the sum of squares of a settled solver's trajectory, penalties of soft bounds left out."""
    model = case.problem.model.numeric()
    output = ca.Function("h", [model.x, model.u, model.p], [model.output])
    inputs = np.vstack([solver.u, np.zeros((1, solver.u.shape[1]))])
    residual = np.array(
        [np.array(output(x, u, p)).ravel() - y for x, u, p, y in zip(solver.x, inputs, solver.p, solver.y, strict=True)]
    )
    return float((solver.w * residual**2).sum())


@pytest.mark.parametrize("name", ["articulated_tractor", "tricycle_trailer"])
def test_a_box_that_is_a_point_is_a_given_state(named: Any, name: str) -> None:
    case = named(name)
    given, point = case.solver(), freed(case, 1e-3).solver()
    point.initial_lower[:] = point.initial_upper[:] = case.initial
    settled(given)
    settled(point)
    np.testing.assert_allclose(point.x, given.x, atol=1e-9)
    np.testing.assert_allclose(point.u, given.u, atol=1e-9)


def test_the_chosen_state_is_the_best_of_the_box(named: Any) -> None:
    case, half_widths = named("articulated_tractor"), np.array([0.0, 0.05, 0.02, 0.01])
    solver = freed(case, 1e-6).solver()
    solver.initial_lower[:], solver.initial_upper[:] = case.initial - half_widths, case.initial + half_widths
    best = cost(settled(solver), case)
    assert (np.abs(solver.x[0] - case.initial) <= half_widths + 1e-9).all()
    rng = np.random.default_rng(2)
    for _ in range(20):
        other = case.solver()
        other.initial[:] = case.initial + half_widths * rng.uniform(-1.0, 1.0, 4)
        assert cost(settled(other), case) > best - 1e-9


def test_without_a_box_a_heavy_weight_holds_the_state_and_a_light_one_lets_it_go(named: Any) -> None:
    case = named("articulated_tractor")
    heavy, light = (settled(freed(case, weight).solver()) for weight in (1e9, 1e-6))
    np.testing.assert_allclose(heavy.x[0], case.initial, atol=1e-6)
    assert np.abs(light.x[0] - case.initial).max() > 1e-2
    assert cost(light, case) < cost(heavy, case)


def test_weights_of_a_free_state_are_one_per_state(named: Any) -> None:
    problem = named("articulated_tractor").problem
    assert isinstance(problem, ControlProblem)
    with pytest.raises(SolverError, match="initial_weights: 'yaw', 'steering' is missing"):
        replace(problem, initial_weights={"x": 1.0, "y": 1.0})
