"""What the quadratic program does with input that no solver can use, and when it needs no interior point."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes
from drawbar.signals import SolverStatus

SIZES = Sizes(stages=8, states=2, inputs=2, bounds=24, free_initial=False)


@pytest.fixture(scope="module")
def program() -> QuadraticProgram:
    return QuadraticProgram(SIZES)


@pytest.fixture
def problem(stage_problem: Callable[..., Any], program: QuadraticProgram) -> Any:
    """A feasible problem with active bounds, already in the program."""
    rng = np.random.default_rng(4)
    while True:
        problem = stage_problem(rng, SIZES)
        problem.into(program)
        if program.solve() == SolverStatus.SOLVED and program.array("iterations")[0] > 0:
            return problem


def test_without_a_bound_in_the_way_one_sweep_is_the_answer(problem: Any, program: QuadraticProgram) -> None:
    program.array("lower")[:], program.array("upper")[:] = -np.inf, np.inf
    assert program.solve() == SolverStatus.SOLVED
    assert program.array("iterations")[0] == 0
    T, t = problem.reach()
    v = np.linalg.solve(T.T @ problem.hessian() @ T, -T.T @ (problem.hessian() @ t + problem.g))
    np.testing.assert_allclose(program.array("z"), T @ v + t, rtol=1e-9, atol=1e-9)
    assert not program.array("multiplier").any()


@pytest.mark.parametrize("shift", [0.0, 1e-9])
def test_bounds_that_are_active_with_zero_multiplier(shift: float, problem: Any, program: QuadraticProgram) -> None:
    program.array("lower")[:], program.array("upper")[:] = -np.inf, np.inf
    program.solve()
    free = program.array("z").copy()
    program.array("upper")[:] = free[problem.bound] - shift
    assert program.solve() == SolverStatus.SOLVED
    assert (program.array("iterations")[0] > 0) == (shift > 0.0)
    H, z = problem.hessian(), program.array("z")
    assert (z[problem.bound] <= free[problem.bound] + 1e-8).all()
    costs = [0.5 * point @ H @ point + problem.g @ point for point in (z, free)]
    assert costs[0] == pytest.approx(costs[1], rel=1e-7)


def test_inputs_pinned_by_equal_bounds_stay_there(problem: Any, program: QuadraticProgram) -> None:
    inputs = problem.bound >= (SIZES.stages + 1) * SIZES.states
    program.array("lower")[~inputs], program.array("upper")[~inputs] = -np.inf, np.inf
    program.array("lower")[inputs] = program.array("upper")[inputs] = 0.125
    assert program.solve() == SolverStatus.SOLVED
    np.testing.assert_allclose(program.array("z")[problem.bound[inputs]], 0.125, atol=1e-8)


@pytest.mark.usefixtures("problem")
@pytest.mark.parametrize("bad", [(0.2, 0.1), (np.nan, 1.0), (-1.0, np.nan)])
def test_crossed_bounds_are_bad_input(bad: tuple[float, float], program: QuadraticProgram) -> None:
    program.array("lower")[3], program.array("upper")[3] = bad
    assert program.solve() == SolverStatus.BAD_INPUT


@pytest.mark.usefixtures("problem")
@pytest.mark.parametrize("prices", [(0.0, 0.0), (-1.0, 5.0), (1.0, -1.0), (np.nan, 1.0)])
def test_soft_bound_without_a_price_is_bad_input(prices: tuple[float, float], program: QuadraticProgram) -> None:
    program.array("soft_linear")[3], program.array("soft_quadratic")[3] = prices
    assert program.solve() == SolverStatus.BAD_INPUT


@pytest.mark.usefixtures("problem")
@pytest.mark.parametrize("index", [-1, 42, 2**31 - 1, -(2**31)])
def test_bound_on_a_variable_that_is_not_there_is_bad_input(index: int, program: QuadraticProgram) -> None:
    assert program.array("z").size == 34
    program.array("bound")[0] = index
    assert program.solve() == SolverStatus.BAD_INPUT


@pytest.mark.usefixtures("problem")
@pytest.mark.parametrize("name", ["Q", "S", "R", "A", "B", "c", "g", "initial", "soft_linear", "soft_quadratic"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e308])
def test_numbers_that_are_none_never_pass_as_solved(name: str, value: float, program: QuadraticProgram) -> None:
    if name == "soft_linear" and value == np.inf:
        pytest.skip("an infinite price is how a hard bound is written")
    program.array(name).flat[-1] = value
    status = program.solve()
    if status == SolverStatus.SOLVED:
        assert np.isfinite(value), f"{name} = {value} was called solved"
        assert np.isfinite(program.array("z")).all()


@pytest.mark.usefixtures("problem")
def test_cost_without_a_minimum_is_not_solved(program: QuadraticProgram) -> None:
    program.array("R")[2] = -np.eye(2) * 1e6
    assert program.solve() == SolverStatus.NOT_FINITE


@pytest.mark.usefixtures("problem")
def test_answer_that_rounding_has_spoilt_fails_the_check(program: QuadraticProgram) -> None:
    program.array("lower")[:], program.array("upper")[:] = -np.inf, np.inf
    program.array("B")[:] *= 1e-3
    outcomes = set()
    for seed in range(20):  # rounding differs between compilers: it may spoil the factorisation first
        A = np.random.default_rng(seed).normal(size=(SIZES.stages, 2, 2))
        program.array("A")[:] = 1e7 * A  # a state grows to 1e56, and must come back
        outcomes.add(program.solve())
        assert not program.array("kkt")[0] <= 1e-8
    assert SolverStatus.CHECK_FAILED in outcomes
    assert outcomes <= {SolverStatus.CHECK_FAILED, SolverStatus.NOT_FINITE}


def test_hard_bounds_that_exclude_each_other_are_infeasible(problem: Any, program: QuadraticProgram) -> None:
    program.array("bound")[1] = program.array("bound")[0]
    program.array("lower")[:2], program.array("upper")[:2] = (-2.0, 1.0), (-1.0, 2.0)
    assert program.solve() == SolverStatus.INFEASIBLE
    problem.into(program)
    assert program.solve() == SolverStatus.SOLVED, "a failure leaves nothing behind"
