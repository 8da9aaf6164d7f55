"""Rounding: problems with states that nothing else moves, on their bounds.

A dense program whose equations were eliminated has them: a coefficient of 1e-16 in the place of zero. An input that is
held against such a state has multipliers of 1e16.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from drawbar.benchmark.hostile.construct import HostileProblem, decades, optimal_problem, with_optimum
from drawbar.benchmark.hostile.recipe import DENSE, GIVEN, Recipe
from drawbar.geometry import Floats
from drawbar.optimal.stage_problem import StageProblem

_ROUNDING = 1e-16
_STILL = 0.4
"""share of the states that stand still, at least one"""


def _noise(rng: np.random.Generator, shape: tuple[int, ...]) -> Floats:
    return np.asarray(_ROUNDING * rng.normal(size=shape) * (rng.random(shape) < 0.5))


def _standing_still(rng: np.random.Generator, problem: StageProblem, still: NDArray[np.intp]) -> StageProblem:
    """Return the problem with these states (their indices) moved by rounding alone."""
    A, B = problem.A.copy(), problem.B.copy()
    A[:, still], B[:, still] = _noise(rng, A[:, still].shape), _noise(rng, B[:, still].shape)
    A[:, still, still] = 1.0
    return replace(problem, A=A, B=B)


def moved_by_rounding(rng: np.random.Generator) -> HostileProblem:
    """Return a problem whose inputs are bounded, as are the states that stand still: all of these on their bounds."""
    choice = DENSE if rng.random() < 0.5 else GIVEN[1:]
    recipe = Recipe(sizes=(choice[rng.integers(len(choice))],), states_bounded=(0.0, 0.0))
    truth = optimal_problem(rng, "moved by rounding", recipe)
    assert truth.optimum is not None
    problem, z = truth.problem, truth.optimum.copy()
    nx, states = problem.sizes.states, problem.bound < (problem.sizes.stages + 1) * problem.sizes.states
    still = np.flatnonzero(rng.permutation(nx) < max(1, round(_STILL * nx)))
    x, _ = problem.split(z)
    x[:, still] = x[0, still]
    value = z[problem.bound]
    on_bound = states & np.isin(problem.bound % nx, still)
    width = decades(rng, (-0.5, 0.7), value.size)
    side = rng.integers(-1, 2, value.size)
    lower = np.where(on_bound, value - width * (side > 0), problem.lower)
    upper = np.where(on_bound, value + width * (side < 0), problem.upper)
    pull = decades(rng, (-3.0, 2.0), value.size) * (rng.random(value.size) < 0.5)
    net = np.zeros(z.size)
    np.add.at(net, problem.bound, pull * ((lower == value) * 1.0 - (upper == value) * 1.0))
    draft = replace(_standing_still(rng, problem, still), lower=lower, upper=upper)
    pi = rng.normal(size=(problem.sizes.stages + 1, nx))
    return HostileProblem(name=truth.name, problem=with_optimum(draft, z, pi, net), optimum=z)
