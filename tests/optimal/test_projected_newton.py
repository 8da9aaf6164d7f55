"""Projected Newton (projected_newton.h) on bounds of a steering's rate and angle."""

import numpy as np
import pytest

from drawbar.benchmark.hostile.construct import HostileProblem
from drawbar.benchmark.hostile.solvers import clarabel
from drawbar.benchmark.hostile.verdict import Verdict, judge
from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes
from drawbar.optimal.stage_problem import StageProblem
from drawbar.signals import SolverStatus

SIZES = Sizes(stages=10, states=2, inputs=1, bounds=20, free_initial=False)
PROBLEMS = 150
FEW = 3
"""passes that nearly all of these need at most"""


@pytest.fixture(scope="module")
def program() -> QuadraticProgram:
    return QuadraticProgram(SIZES)


def steering(rng: np.random.Generator, *, linear: float, quadratic: float) -> StageProblem:
    """Return a steering that has to move a body aside: states are its distance and the angle, the input is the rate.

    The angle is bounded softly, the rate is bounded hard.
    """
    N, nx, nu = SIZES.stages, SIZES.states, SIZES.inputs
    interval, target = 0.2, rng.uniform(-0.6, 0.6)
    angles, rates = 2 * np.arange(1, N + 1) + 1, (N + 1) * nx + np.arange(N)
    g = np.zeros((N + 1) * nx + N * nu)
    g[: (N + 1) * nx : 2] = -2.0 * target
    angle, rate = rng.uniform(0.1, 0.4), rng.uniform(0.2, 1.5)
    return StageProblem(
        sizes=SIZES,
        Q=np.tile(np.diag([2.0, 0.01]), (N + 1, 1, 1)),
        S=np.zeros((N, nu, nx)),
        R=np.full((N, nu, nu), 10.0 ** rng.uniform(-1.0, 1.0)),
        A=np.tile([[1.0, rng.uniform(0.1, 1.0)], [0.0, 1.0]], (N, 1, 1)),
        B=np.tile([[0.0], [interval]], (N, 1, 1)),
        c=0.02 * rng.standard_normal((N, nx)) * [1.0, 0.0],
        g=g,
        initial=np.array([rng.uniform(-0.5, 0.5), rng.uniform(-1.3, 1.3) * angle]),
        lower=-np.repeat([angle, rate], N),
        upper=np.repeat([angle, rate], N),
        soft_linear=np.repeat([linear, np.inf], N),
        soft_quadratic=np.repeat([quadratic, 0.0], N),
        bound=np.concatenate([angles, rates]).astype(np.int32),
    )


def by_projected_newton(problem: StageProblem, program: QuadraticProgram) -> bool:
    """Return whether no bound that is not active has a multiplier: an interior point leaves a little of each."""
    value = program.array("z")[problem.bound]
    distances = np.stack([value - problem.lower, problem.upper - value], axis=1).ravel()
    return bool((program.array("multiplier")[distances > 1e-6] == 0.0).all())


@pytest.mark.parametrize(("linear", "quadratic"), [(1000.0, 0.0), (0.5, 0.0), (0.5, 20.0), (np.inf, 0.0)])
def test_steering_at_its_limits(linear: float, quadratic: float, program: QuadraticProgram) -> None:
    rng = np.random.default_rng(13)
    bounded, without_interior_point, few_passes, held, given_way = 0, 0, 0, 0, 0
    for _ in range(PROBLEMS):
        problem = steering(rng, linear=linear, quadratic=quadratic)
        if linear == np.inf:
            problem.initial[1] *= 0.5  # hard limits: let there be a point
        problem.into(program)
        assert program.solve() == SolverStatus.SOLVED
        truth = HostileProblem(name="steering", problem=problem, optimum=program.array("z").copy())
        assert judge(truth, clarabel(problem)) == Verdict.SOLVED
        if program.array("iterations")[0] > 0:
            bounded += 1
            without_interior_point += by_projected_newton(problem, program)
            few_passes += int(program.array("iterations")[0] <= FEW)
            multiplier, violation = program.array("multiplier"), program.array("violation")
            held += int((multiplier[violation == 0.0] > 1e-6).sum())
            given_way += int((violation > 1e-6).sum())
    assert without_interior_point >= 0.98 * bounded >= 0.2 * PROBLEMS
    assert few_passes >= 0.9 * bounded
    assert held > bounded
    assert (given_way > 0) == (linear < np.inf)
