"""INFEASIBLE is only said where no point exists, however far out the only ones lie."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes
from drawbar.signals import SolverStatus

SIZES = (
    Sizes(stages=10, states=3, inputs=1, bounds=25, free_initial=False),
    Sizes(stages=2, states=3, inputs=1, bounds=6, free_initial=False),
    Sizes(stages=6, states=5, inputs=2, bounds=24, free_initial=True),
)


def far_point(rng: np.random.Generator, problem: Any) -> Any:
    """Return z that obeys the dynamics under inputs of 1 to 1e4 (the costs draw them to about 1)."""
    N, nx, nu = problem.sizes.stages, problem.sizes.states, problem.sizes.inputs
    u = rng.normal(size=(N, nu)) * 10.0 ** rng.uniform(0, 4)
    x = np.zeros((N + 1, nx))
    x[0] = problem.initial
    for k in range(N):
        x[k + 1] = problem.A[k] @ x[k] + problem.B[k] @ u[k] + problem.c[k]
    return np.concatenate([x.ravel(), u.ravel()])


def far_problem(rng: np.random.Generator, problem: Any) -> Any:
    """Return a feasible problem: hard bounds on some states close around a far point, none on the inputs."""
    at = far_point(rng, problem)[problem.bound]
    bounded = (rng.random(at.size) < 0.4) & (problem.bound < (problem.sizes.stages + 1) * problem.sizes.states)
    width = np.where(bounded, 10.0 ** rng.uniform(-4, 1, at.size), np.inf)
    return replace(
        problem,
        g=problem.g * rng.choice([0.0, 1.0]),
        lower=at - width,
        upper=at + width,
        soft_linear=np.full(at.size, np.inf),
    )


@pytest.mark.parametrize("sizes", SIZES, ids=lambda sizes: f"{sizes.stages}x{sizes.states}")
def test_a_feasible_problem_is_never_called_infeasible(sizes: Sizes, stage_problem: Callable[..., Any]) -> None:
    program, rng = QuadraticProgram(sizes), np.random.default_rng(41)
    solved = 0
    for number in range(300):
        plain = stage_problem(rng, sizes)
        problem = far_problem(rng, replace(plain, B=plain.B * 10.0 ** rng.uniform(-4, 0)))
        units = 10.0 ** rng.uniform(-3, 3, sizes.states), 10.0 ** rng.uniform(-3, 3, sizes.inputs)
        (problem.units(*units) if number % 2 else problem).into(program)
        status = program.solve()
        assert status != SolverStatus.INFEASIBLE, f"problem {number}"
        solved += status == SolverStatus.SOLVED
    assert solved > 285, solved


@pytest.mark.parametrize("gap", [1e-5, 1.0, 1e5])
def test_a_state_just_out_of_reach_of_bounded_inputs(gap: float, stage_problem: Callable[..., Any]) -> None:
    sizes = Sizes(stages=8, states=1, inputs=1, bounds=9, free_initial=False)
    program, rng = QuadraticProgram(sizes), np.random.default_rng(42)
    for _ in range(30):
        problem = stage_problem(rng, sizes)
        inputs, free = np.arange(9, 17), np.full(9, np.inf)
        T, t = replace(problem, bound=inputs).reach()
        farthest = t[8] + np.abs(T[8]).sum()  # of x_8 with every input in -1..1
        bound, upper = np.append(inputs, 8).astype(np.int32), np.append(np.ones(8), np.inf)
        for shift, expected in ((gap, SolverStatus.INFEASIBLE), (-gap, SolverStatus.SOLVED)):
            lower = np.append(-np.ones(8), farthest + shift * abs(farthest))
            replace(problem, bound=bound, lower=lower, upper=upper, soft_linear=free).into(program)
            assert program.solve() == expected
