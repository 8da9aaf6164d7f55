"""The structured quadratic program before independent judges: two interior points and an active-set method.

The judges get the states eliminated and every slack explicit, in well-scaled units; drawbar gets the stages, on every
other problem in units from 1e-3 to 1e3.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import clarabel  # type: ignore[import-untyped]
import daqp
import numpy as np
import piqp  # type: ignore[import-untyped]
import pytest
from scipy import sparse

from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes
from drawbar.signals import SolverStatus

SIZES = (
    Sizes(stages=10, states=3, inputs=1, bounds=25, free_initial=False),
    Sizes(stages=6, states=5, inputs=2, bounds=24, free_initial=True),
    Sizes(stages=8, states=2, inputs=2, bounds=24, free_initial=False),
    Sizes(stages=4, states=1, inputs=1, bounds=7, free_initial=True),
)
PROBLEMS = 500
"""per size"""


def condensed(problem: Any) -> tuple[Floats, Floats, Floats, Floats, float]:
    """Return P, q, G, h, constant of min 1/2 w'Pw + q'w + constant, Gw <= h; w = (x_0 if free, inputs, slacks)."""
    T, t = problem.reach()
    H, own, off = problem.hessian(), T[problem.bound], t[problem.bound]
    soft = np.isfinite(problem.soft_linear)
    sides = [
        (i, sign, limit)
        for sign, limits in ((-1.0, problem.lower), (1.0, problem.upper))
        for i, limit in enumerate(limits)
        if np.isfinite(limit)
    ]
    slack = [r for r, (i, _, _) in enumerate(sides) if soft[i]]
    n, m = T.shape[1], len(slack)
    P, q = np.zeros((n + m, n + m)), np.zeros(n + m)
    P[:n, :n], q[:n] = T.T @ H @ T, T.T @ (H @ t + problem.g)
    G, h = np.zeros((len(sides) + m, n + m)), np.zeros(len(sides) + m)
    for r, (i, sign, limit) in enumerate(sides):
        G[r, :n], h[r] = sign * own[i], sign * (limit - off[i])
    for column, r in enumerate(slack, start=n):
        i = sides[r][0]
        P[column, column], q[column] = problem.soft_quadratic[i], problem.soft_linear[i]
        G[r, column] = G[len(sides) + column - n, column] = -1.0
    return P, q, G, h, float(0.5 * t @ H @ t + problem.g @ t)


def clarabel_cost(P: Floats, q: Floats, G: Floats, h: Floats) -> float:
    """Return the least cost, infinite where there is no feasible point."""
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    upper = sparse.triu(sparse.csc_matrix(P), format="csc")
    cone = [clarabel.NonnegativeConeT(len(h))]
    found = clarabel.DefaultSolver(upper, q, sparse.csc_matrix(G), h, cone, settings).solve()
    infeasible = (clarabel.SolverStatus.PrimalInfeasible, clarabel.SolverStatus.AlmostPrimalInfeasible)
    return float("inf") if found.status in infeasible else float(found.obj_val)


def piqp_cost(P: Floats, q: Floats, G: Floats, h: Floats) -> float:
    solver = piqp.DenseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = 1e-10
    solver.settings.eps_duality_gap_abs = solver.settings.eps_duality_gap_rel = 1e-10
    solver.setup(P, q, None, None, G, None, h)
    solver.solve()
    return float(solver.result.info.primal_obj)


def daqp_finds_a_point(P: Floats, q: Floats, G: Floats, h: Floats) -> bool:
    return bool(daqp.solve(P, q, G, h)[2] == 1)


def with_quadratic_prices(problem: Any) -> Any:
    """Return the problem with soft bounds whose first violation costs nothing."""
    soft = np.isfinite(problem.soft_linear)
    return replace(problem, soft_linear=np.where(soft, 0.0, np.inf), soft_quadratic=np.where(soft, 10.0, 0.0))


def cost(problem: Any, z: Floats) -> float:
    """Return the cost of z, violations of soft bounds included."""
    value = z[problem.bound]
    violation = np.maximum([problem.lower - value, value - problem.upper], 0.0)[:, np.isfinite(problem.soft_linear)]
    linear, quadratic = (a[np.isfinite(problem.soft_linear)] for a in (problem.soft_linear, problem.soft_quadratic))
    penalty = (linear * violation + 0.5 * quadratic * violation**2).sum()
    return float(0.5 * z @ problem.hessian() @ z + problem.g @ z + penalty)


def by_kind(problem: Any, values: Floats) -> Floats:
    """Return the largest of each state's, then each input's values over the stages, at each variable's place."""
    N, nx, nu = problem.sizes.stages, problem.sizes.states, problem.sizes.inputs
    x, u = np.split(np.abs(values), [(N + 1) * nx])
    largest = x.reshape(N + 1, nx).max(axis=0), u.reshape(N, nu).max(axis=0)
    return np.concatenate([np.tile(largest[0], N + 1), np.tile(largest[1], N)]) + 1e-300


def kkt_residual(problem: Any, program: QuadraticProgram) -> float:
    """Return the worst violation of the optimality conditions, each relative to the terms that should cancel.

    Terms of one kind (a state's or an input's, over all stages) share one size, since they share one unit.
    """
    z, pi = program.array("z"), program.array("pi")[1:].ravel()
    lower_multiplier, upper_multiplier = program.array("multiplier").reshape(-1, 2).T
    violation = program.array("violation").reshape(-1, 2).T
    H, (E, e) = problem.hessian(), problem.dynamics()
    net = np.zeros(z.size)
    np.add.at(net, problem.bound, lower_multiplier - upper_multiplier)
    gradient = H @ z + problem.g + E.T @ pi - net
    terms = np.abs(H) @ np.abs(z) + np.abs(problem.g) + np.abs(E.T) @ np.abs(pi) + np.abs(net)
    nx = problem.sizes.states
    if not problem.sizes.free_initial:
        gradient[:nx] = 0.0  # the given state's multiplier is free
    worst = [np.abs(gradient / by_kind(problem, terms)).max()]
    size = by_kind(problem, z)
    worst.append(np.abs((E @ z - e) / size[nx : nx + e.size]).max())
    if not problem.sizes.free_initial:
        worst.append(np.abs((z[:nx] - problem.initial) / size[:nx]).max())
    own, scale = size[problem.bound], 1.0 + abs(cost(problem, z))
    price, growth, soft = problem.soft_linear, problem.soft_quadratic, np.isfinite(problem.soft_linear)
    owed = np.where(price > 0.0, price, by_kind(problem, terms)[problem.bound])
    for multiplier, slack, distance in (
        (lower_multiplier, violation[0], z[problem.bound] - problem.lower),
        (upper_multiplier, violation[1], problem.upper - z[problem.bound]),
    ):
        there = np.isfinite(distance)
        assert (multiplier >= 0.0).all()
        assert (slack >= 0.0).all()
        assert (slack[~soft] == 0.0).all()
        assert (multiplier[~there] == 0.0).all()
        beyond = np.minimum(distance + slack, 0.0)[there]
        worst.append(np.abs(beyond / own[there]).max(initial=0.0))
        remaining = (price + growth * slack - multiplier)[soft]
        worst.append(np.maximum(-remaining / owed[soft], 0.0).max(initial=0.0))
        worst.append(np.abs(multiplier * np.where(there, distance + slack, 0.0)).sum() / scale)
        worst.append(np.abs(remaining * slack[soft]).sum() / scale)
    return float(max(worst))


@pytest.fixture(scope="module", params=range(len(SIZES)), ids=lambda i: f"size{i}")
def program(request: pytest.FixtureRequest) -> tuple[Sizes, QuadraticProgram]:
    sizes = SIZES[request.param]
    return sizes, QuadraticProgram(sizes)


def test_agrees_with_the_judges(program: tuple[Sizes, QuadraticProgram], stage_problem: Callable[..., Any]) -> None:
    sizes, solver = program
    rng = np.random.default_rng(20)
    outcomes = dict.fromkeys(SolverStatus, 0)
    for number in range(PROBLEMS):
        plain = stage_problem(rng, sizes)
        if number % 5 == 0:
            plain = with_quadratic_prices(plain)
        units = 10.0 ** rng.uniform(-3, 3, sizes.states), 10.0 ** rng.uniform(-3, 3, sizes.inputs)
        given = plain.units(*units) if number % 2 else plain
        given.into(solver)
        status = solver.solve()
        outcomes[status] += 1
        P, q, G, h, constant = condensed(plain)
        best, feasible = clarabel_cost(P, q, G, h) + constant, daqp_finds_a_point(P, q, G, h)
        assert np.isfinite(best) == feasible, "the judges disagree on feasibility"
        assert (status == SolverStatus.INFEASIBLE) == (not feasible), f"problem {number}: {status.name}"
        if status == SolverStatus.SOLVED:
            assert kkt_residual(given, solver) <= 1e-8, f"problem {number}"
            found = cost(given, solver.array("z"))
            for judged in (best, piqp_cost(P, q, G, h) + constant):
                assert found == pytest.approx(judged, rel=1e-7, abs=1e-7), f"problem {number}"
    assert outcomes[SolverStatus.SOLVED] + outcomes[SolverStatus.INFEASIBLE] == PROBLEMS, outcomes
    assert outcomes[SolverStatus.INFEASIBLE] >= 5, "too few infeasible problems to prove anything"
