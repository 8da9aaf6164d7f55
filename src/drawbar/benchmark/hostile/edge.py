"""Edge problems, nearly feasible or nearly infeasible, with the truth in closed form.

Either a state is to be farther out than bounded inputs (and a bounded first state) can bring it, or two bounds are to
hold on states that no input moves; by a margin, or within it.
"""

from dataclasses import dataclass, replace

import numpy as np

from drawbar.benchmark.hostile.construct import HostileProblem, decades, optimal_problem, with_optimum
from drawbar.benchmark.hostile.recipe import FREE, GIVEN, Recipe
from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import Sizes
from drawbar.optimal.stage_problem import StageProblem

_FEASIBLE_MARGIN = (-8.5, -1.0)
_INFEASIBLE_MARGIN = (-9.0, 0.0)
_FIRST_MARGIN = (-5.0, 0.0)
_OPEN = Recipe(inputs_bounded=0.0, states_bounded=(0.0, 0.0), growth=(0.7, 1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Corner:
    """How far a row of T v + t reaches with every v in -1..1."""

    row: Floats
    end: Floats
    """the v that is farthest"""
    farthest: float
    size: float
    """sum of the terms' sizes"""


def _corner(T: Floats, t: Floats, at: int) -> _Corner:
    end = np.where(T[at] >= 0.0, 1.0, -1.0)
    farthest, size = float(t[at] + np.abs(T[at]).sum()), float(abs(t[at]) + np.abs(T[at]).sum())
    return _Corner(row=T[at], end=end, farthest=farthest, size=size)


def _boxed(problem: StageProblem, at: int, least: float) -> StageProblem:
    """Return the problem with inputs and a free first state in -1..1, and z[at] >= least."""
    N, nx = problem.sizes.stages, problem.sizes.states
    bound = problem.bound.copy()
    inside = (bound >= (N + 1) * nx) | (bound < nx)
    lower, upper = np.where(inside, -1.0, -np.inf), np.where(inside, 1.0, np.inf)
    bound[-1], lower[-1], upper[-1] = at, least, np.inf
    lower[-4:-1], upper[-4:-1] = -np.inf, np.inf
    return replace(problem, bound=bound, lower=lower, upper=upper)


def _start(rng: np.random.Generator) -> tuple[StageProblem, int]:
    """Return a problem without bounds and a state to be moved far."""
    choice = GIVEN[1:] + FREE[1:4]
    recipe = replace(_OPEN, sizes=(choice[rng.integers(len(choice))],))
    problem = optimal_problem(rng, "", recipe).problem
    N, nx = problem.sizes.stages, problem.sizes.states
    problem = replace(problem, c=0.1 * problem.c)
    return problem, int(rng.integers(N // 2 + 1, N + 1) * nx + rng.integers(nx))


def just_feasible(rng: np.random.Generator) -> HostileProblem:
    """Return a problem whose feasible points are a corner of the box, cut off by a thin margin."""
    problem, at = _start(rng)
    T, t = problem.reach()
    corner = _corner(T, t, at)
    margin = float(decades(rng, _FEASIBLE_MARGIN)[0]) * corner.size
    inner = int(np.argmax(np.abs(corner.row)))
    v = corner.end.copy()
    v[inner] -= np.clip(margin / corner.row[inner], -1.0, 1.0)
    z = T @ v + t
    boxed = _boxed(problem, at, z[at])
    own = problem.sizes.states if problem.sizes.free_initial else 0
    net = np.zeros(z.size)
    pull = decades(rng, (-2.0, 1.0), v.size)
    pull[inner] = 0.0
    moved = np.concatenate([np.arange(own), np.arange((problem.sizes.stages + 1) * problem.sizes.states, z.size)])
    net[moved] = -corner.end * pull
    net[at] += decades(rng, (-2.0, 1.0))[0]
    pi = rng.normal(size=(problem.sizes.stages + 1, problem.sizes.states))
    return HostileProblem(name="just feasible", problem=with_optimum(boxed, z, pi, net), optimum=z)


def just_infeasible(rng: np.random.Generator) -> HostileProblem:
    """Return a problem whose bounded state must be farther out than anything brings it."""
    problem, at = _start(rng)
    corner = _corner(*problem.reach(), at)
    margin = float(decades(rng, _INFEASIBLE_MARGIN)[0]) * corner.size
    return HostileProblem(name="just infeasible", problem=_boxed(problem, at, corner.farthest + margin), optimum=None)


def _hidden(rng: np.random.Generator, sizes: Sizes) -> tuple[StageProblem, Floats]:
    """Return a problem without bounds and w: w'x_k = w'x_0 for all k, whatever the inputs, without any rounding.

    In steered coordinates the last state stands still; whole numbers mix it with the others.
    """
    nx = sizes.states
    problem = optimal_problem(rng, "", replace(_OPEN, sizes=(sizes,))).problem
    A, B = np.round(4.0 * problem.A) / 8.0, np.round(8.0 * problem.B) / 8.0
    A[:, -1, :] = 0.0
    A[:, -1, -1] = 1.0
    B[:, -1, :] = 0.0
    mix, back = np.eye(nx), np.eye(nx)
    w = rng.integers(-3, 4, nx - 1).astype(float)
    mix[-1, :-1], back[-1, :-1] = w, -w  # y = mix x; the last of y is w'x_others + x_last
    A, B = back @ A @ mix, back @ B
    return replace(problem, A=A, B=B, c=np.zeros_like(problem.c)), mix[-1]


def hidden_conflict(rng: np.random.Generator) -> HostileProblem:
    """Return a problem without bounds on inputs, whose bounds on states ask another value of what no input moves.

    With a given first state, w'x_N is what w'x_0 was; every state of the last stage is bounded so that w'x_N cannot be,
    by a margin. With a free one the first stage is bounded too.
    """
    choice = GIVEN[1:6] + FREE[1:5]
    problem, w = _hidden(rng, choice[rng.integers(len(choice))])
    N, nx = problem.sizes.stages, problem.sizes.states
    first = np.round(64.0 * rng.normal(size=nx)) / 64.0
    last = np.round(64.0 * rng.normal(size=nx)) / 64.0
    carrier = nx - 1  # w[carrier] is 1
    last[carrier] += w @ (first - last)  # now w'last = w'first, exactly
    width = np.where(w != 0.0, 2.0 ** -rng.integers(2, 12), 0.5)
    margin = float(decades(rng, _INFEASIBLE_MARGIN)[0]) * float(np.abs(w) @ (np.abs(first) + np.abs(last) + width))
    lower, upper = np.full(problem.lower.size, -np.inf), np.full(problem.lower.size, np.inf)
    for j in range(nx):
        slot = np.flatnonzero(problem.bound == N * nx + j)[0]
        # the least that w'x_N can be is above w'first by the margin
        lower[slot] = last[j] if w[j] > 0 else last[j] - width[j]
        upper[slot] = last[j] + width[j] if w[j] > 0 else last[j]
        if j == carrier:
            lower[slot] += margin
            upper[slot] += margin
        if problem.sizes.free_initial:
            slot = np.flatnonzero(problem.bound == j)[0]
            lower[slot] = first[j] - width[j] if w[j] > 0 else first[j]
            upper[slot] = first[j] if w[j] > 0 else first[j] + width[j]
    return HostileProblem(
        name="hidden conflict",
        problem=replace(problem, initial=first, lower=lower, upper=upper),
        optimum=None,
    )


def first_state(rng: np.random.Generator) -> HostileProblem:
    """Return a problem with a bound on its given first state, which obeys it, or is beyond it by a margin."""
    truth = optimal_problem(rng, "first state", Recipe(sizes=GIVEN))
    problem, nx = truth.problem, truth.problem.sizes.states
    bound, lower, upper = problem.bound.copy(), problem.lower.copy(), problem.upper.copy()
    j, within = int(rng.integers(nx)), bool(rng.random() < 0.5)
    margin = float(decades(rng, _FIRST_MARGIN)[0]) * max(1.0, np.abs(problem.initial).max())
    bound[-1] = j
    lower[-1] = problem.initial[j] + (-margin * rng.integers(2) if within else margin)
    upper[-1] = problem.initial[j] + margin * rng.integers(2) if within else np.inf
    bounded = replace(problem, bound=bound, lower=lower, upper=upper)
    return replace(truth, problem=bounded, optimum=truth.optimum if within else None)
