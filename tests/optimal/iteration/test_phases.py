"""Preparation, feedback and shift: gaps, bad input, failures, and the step from one sample to the next."""

from typing import Any

import numpy as np
import pytest

from drawbar.optimal import EstimationProblem, EstimationSolver
from drawbar.optimal.problem import row
from drawbar.signals import SolverStatus


def settled(case: Any) -> Any:
    """Return the case's solver after some iterations."""
    solver = case.solver()
    for _ in range(6):
        solver.prepare()
        assert solver.feedback() == SolverStatus.SOLVED
    return solver


def test_shift_moves_everything_by_a_sample_and_predicts_the_end(case: Any) -> None:
    solver = settled(case)
    x, u, y, p = solver.x.copy(), solver.u.copy(), solver.y.copy(), case.p
    solver.shift()
    assert solver.prepare() == SolverStatus.SOLVED
    np.testing.assert_array_equal(solver.x[:-1], x[1:])
    np.testing.assert_array_equal(solver.u, np.vstack([u[1:], u[-1]]))
    np.testing.assert_array_equal(solver.y, np.vstack([y[1:], y[-1]]))
    if p.size:
        np.testing.assert_array_equal(solver.p, np.vstack([p[1:], p[-1]]))
    defects = solver.workspace.array("qp.c")
    np.testing.assert_array_equal(defects[-1], 0.0)
    assert np.abs(defects).max() < 1e-5, "the shifted trajectory is one of the model"


def test_missing_measurements_weigh_nothing(named: Any) -> None:
    case = named("articulated_estimator")
    masked, removed = case.solver(), case.solver()
    gaps = np.isnan(case.y)
    assert gaps.any()
    removed.y[gaps] = 1e3  # whatever it says: its weight is zero
    removed.w[gaps] = 0.0
    for solver in (masked, removed):
        for _ in range(4):
            solver.prepare()
            assert solver.feedback() == SolverStatus.SOLVED
    np.testing.assert_array_equal(masked.x, removed.x)
    np.testing.assert_array_equal(masked.u, removed.u)


@pytest.mark.parametrize("late", [True, False])
def test_measurement_may_come_between_preparation_and_feedback(late: bool, named: Any) -> None:
    case = named("articulated_estimator")
    solver, plain = case.solver(), case.solver()
    solver.y[-1] = np.nan if late else 7.0  # the newest row is not known yet, or stale
    solver.prepare()
    solver.y[-1] = case.y[-1]
    plain.prepare()
    assert solver.feedback() == plain.feedback() == SolverStatus.SOLVED
    np.testing.assert_allclose(solver.x, plain.x, rtol=0, atol=1e-12)


def test_no_measurement_at_all_leaves_the_prior(named: Any) -> None:
    case = named("articulated_estimator")
    solver = case.solver()
    solver.y[:, :8] = np.nan
    solver.prepare()
    assert solver.feedback() == SolverStatus.SOLVED
    moved = np.clip(case.initial, *_limits(case.problem))
    np.testing.assert_allclose(solver.x[0], moved, rtol=0, atol=1e-6)


def _limits(problem: EstimationProblem) -> tuple[Any, Any]:
    names = [v.name for v in (*problem.model.states, *problem.model.parameters)]
    bounds = [problem.bounds.get(name) for name in names]
    return (
        np.array([-np.inf if b is None else b.lower for b in bounds]),
        np.array([np.inf if b is None else b.upper for b in bounds]),
    )


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_input_that_is_no_number_is_refused_and_leaves_the_trajectory(case: Any, value: float) -> None:
    names = ["prior"] if isinstance(case.problem, EstimationProblem) else ["initial", "p", "y"]
    names += ["y"] if isinstance(case.problem, EstimationProblem) and not np.isnan(value) else []
    for name in names:
        solver = settled(case)
        solver.prepare()
        x, u = solver.x.copy(), solver.u.copy()
        solver.workspace.array(name).flat[-1] = value
        assert solver.feedback() == SolverStatus.BAD_INPUT, name
        assert solver.status == SolverStatus.BAD_INPUT
        np.testing.assert_array_equal(solver.x, x)
        np.testing.assert_array_equal(solver.u, u)


def test_weights_that_are_no_numbers_never_pass_as_solved(case: Any) -> None:
    for value in (np.nan, np.inf, -1e9):
        solver = settled(case)
        solver.w[2, 0] = value
        x = solver.x.copy()
        outcomes = {solver.prepare(), solver.feedback()}
        assert outcomes != {SolverStatus.SOLVED}, value
        np.testing.assert_array_equal(solver.x, x)


@pytest.mark.parametrize("value", [-1e-9, np.nan])
def test_negative_weight_is_refused_moves_nothing_and_can_be_put_right(case: Any, value: float) -> None:
    solver, other = settled(case), settled(case)
    right = solver.w[-1, -1]
    solver.w[-1, -1] = value
    work = [solver.x, solver.u, solver.y]
    if isinstance(solver, EstimationSolver):
        work += [solver.root, solver.prior, solver.workspace.array("window.newest")]
    before = [array.copy() for array in work]
    if isinstance(solver, EstimationSolver):
        assert solver.advance() == SolverStatus.BAD_INPUT
    assert solver.prepare() == SolverStatus.BAD_INPUT
    assert solver.feedback() == SolverStatus.BAD_INPUT
    assert solver.solve().status == SolverStatus.BAD_INPUT
    for array, kept in zip(work, before, strict=True):
        np.testing.assert_array_equal(array, kept)
    solver.w[-1, -1] = right
    assert (solver.prepare(), solver.feedback()) == (other.prepare(), other.feedback()) == (0, 0)
    np.testing.assert_array_equal(solver.x, other.x)


def test_failing_step_leaves_the_trajectory_untouched_and_recovers(case: Any) -> None:
    solver = settled(case)
    solver.prepare()
    x, u = solver.x.copy(), solver.u.copy()
    lower, upper = (solver.workspace.array(name) for name in ("lower", "upper"))
    kept = lower[0]
    lower[0] = upper[0] + 1.0
    assert solver.feedback() == SolverStatus.BAD_INPUT
    np.testing.assert_array_equal(solver.x, x)
    np.testing.assert_array_equal(solver.u, u)
    lower[0] = kept
    solver.prepare()
    assert solver.feedback() == SolverStatus.SOLVED


def test_bounds_are_respected(case: Any) -> None:
    solver = settled(case)
    z = np.concatenate([solver.x.ravel(), solver.u.ravel()])
    value = z[solver.workspace.array("qp.bound")]
    lower, upper = (solver.workspace.array(name) for name in ("lower", "upper"))
    assert (value >= lower - 1e-8).all()
    assert (value <= upper + 1e-8).all()
    assert (np.minimum(value - lower, upper - value) < 1e-6).any(), "none is active"


def test_soft_state_bound_gives_way_where_a_hard_one_cannot_hold(named: Any) -> None:
    case = named("articulated_tractor")
    solver = case.solver()
    index = solver.workspace.array("qp.bound")
    lower, upper = (solver.workspace.array(name) for name in ("lower", "upper"))
    index[-1], lower[-1], upper[-1] = 1 * solver.x.shape[1] + 1, -0.05, 0.05  # y_1, from y_0 = 0.4
    solver.workspace.array("qp.soft_linear")[-1] = np.inf
    solver.prepare()
    assert solver.feedback() == SolverStatus.INFEASIBLE
    solver.workspace.array("qp.soft_linear")[-1] = 5.0
    solver.prepare()
    assert solver.feedback() == SolverStatus.SOLVED
    assert solver.x[1, 1] > 0.05
    assert solver.workspace.array("qp.violation").max() > 0.3


def test_estimator_starts_at_its_prior_without_measurements(named: Any) -> None:
    case = named("tricycle_estimator")
    solver = EstimationSolver(case.problem, case.initial)
    assert np.isnan(solver.y).all()
    np.testing.assert_array_equal(solver.x, np.tile(case.initial, (len(solver.x), 1)))
    np.testing.assert_allclose(
        np.diag(solver.root), 1.0 / np.array(row(case.problem.prior_deviation, case.problem.estimated))
    )


def test_bound_on_a_variable_that_is_not_there_is_bad_input(case: Any) -> None:
    for index in (-1, 2**31 - 1, -(2**31)):
        solver = settled(case)
        solver.workspace.array("qp.bound")[0] = index
        solver.prepare()
        assert solver.feedback() == SolverStatus.BAD_INPUT


def test_known_parameters_are_an_array_of_their_own_even_when_there_are_none(case: Any) -> None:
    p = case.solver().workspace.array("p")
    assert p.shape == case.p.shape


def test_oldest_stage_that_cannot_be_absorbed_starts_the_arrival_cost_anew(named: Any) -> None:
    case = named("articulated_estimator")
    solver = settled(case)
    solver.workspace.array("window.newest")[:] = case.problem.horizon
    assert solver.advance() == SolverStatus.SOLVED
    solver.feedback()
    following = solver.x[1].copy()
    solver.workspace.array("process")[0] = 1e200  # its square is no number any more
    assert solver.advance() == SolverStatus.NOT_FINITE
    np.testing.assert_array_equal(
        solver.root, np.diag(1.0 / np.array(row(case.problem.prior_deviation, case.problem.estimated)))
    )
    np.testing.assert_array_equal(solver.prior, following)
    assert solver.feedback() == SolverStatus.SOLVED


@pytest.mark.parametrize("name", ["articulated_estimator", "tricycle_estimator"])
def test_slide_linearises_what_stays_as_a_preparation_does(name: str, named: Any) -> None:
    case = named(name)
    solver = settled(case)
    solver.workspace.array("window.newest")[:] = case.problem.horizon
    slid = []
    for phases in ([solver.slide, solver.prepare], [solver.prepare]):
        assert [phase() for phase in phases] == [SolverStatus.SOLVED] * len(phases)
        slid.append([solver.workspace.array(field).copy() for field in ("qp.A", "qp.B", "qp.c", "x")])
    for with_slide, alone in zip(*slid, strict=True):
        np.testing.assert_allclose(with_slide, alone, rtol=0, atol=1e-13)


@pytest.mark.parametrize("name", ["articulated_estimator", "tricycle_estimator"])
def test_bounds_of_a_free_first_state_need_no_interior_point(name: str, named: Any) -> None:
    solver = settled(named(name))
    array = solver.workspace.array
    place = array("qp.bound")[0]
    wanted = 1.2  # beyond what both find without bounds
    array("lower")[0], array("upper")[0] = wanted, wanted + 1.0
    solver.prepare()
    assert solver.feedback() == SolverStatus.SOLVED
    assert solver.iterations > 0
    assert array("qp.factored")[0] == 1, "the factorisation without a barrier is still there"
    assert array("qp.multiplier")[0] > 0.0
    assert array("x")[0, place] == pytest.approx(wanted, abs=1e-12)
