"""Problems made around their optimum: multipliers are drawn first, and the gradient is what makes them right.

With a convex cost the conditions of Karush, Kuhn and Tucker are sufficient: g = -(H z + E' pi - net) makes z optimal
for any costates pi and any multipliers of active bounds that have the right sign.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drawbar.benchmark.hostile.recipe import SPARE, Recipe
from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import Sizes
from drawbar.optimal.stage_problem import StageProblem


@dataclass(frozen=True, slots=True, kw_only=True)
class HostileProblem:
    """A problem and its truth."""

    name: str
    """of its class"""
    problem: StageProblem
    optimum: Floats | None
    """(NZ,) an optimal point; None: there is no point at all"""


def decades(rng: np.random.Generator, least_and_most: tuple[float, float], size: int | tuple[int, ...] = 1) -> Floats:
    """Return numbers (size) whose decimal logarithms are uniform between the two given."""
    return np.asarray(10.0 ** rng.uniform(*least_and_most, size))


def with_optimum(problem: StageProblem, z: Floats, pi: Floats, net: Floats) -> StageProblem:
    """Return the problem with c, initial and g such that z is optimal.

    Args:
        problem: everything else.
        z: (NZ,).
        pi: (N+1, NX) costates; the first belongs to a given initial state, and to none where it is free.
        net: (NZ,) lower minus upper multiplier of each variable.
    """
    N, nx = problem.sizes.stages, problem.sizes.states
    x, _ = problem.split(z)
    free = replace(problem, c=np.zeros((N, nx)))
    gradient = problem.weighed(z) - net
    gx, gu = problem.split(gradient)
    gx[:-1] += np.einsum("kij,ki->kj", problem.A, pi[1:])
    gx[1:] -= pi[1:]
    if not problem.sizes.free_initial:
        gx[0] -= pi[0]
    gu += np.einsum("kia,ki->ka", problem.B, pi[1:])
    return replace(problem, c=-free.defects(z), initial=x[0].copy(), g=-gradient)


def _costs(rng: np.random.Generator, sizes: Sizes, recipe: Recipe) -> tuple[Floats, Floats, Floats]:
    """Return Q, S, R, positive semidefinite together."""
    N, nx, nu = sizes.stages, sizes.states, sizes.inputs
    n = nx + nu
    axes = np.linalg.qr(rng.normal(size=(N + 1, n, n)))[0]
    size = decades(rng, (-recipe.condition_decades, 0.0), (N + 1, n)) * (rng.random((N + 1, n)) < recipe.rank)
    H = np.einsum("kij,kj,klj->kil", axes, size, axes)
    H = 0.5 * (H + H.transpose(0, 2, 1))
    if recipe.input_weight_decades is not None:
        H[:, nx:, :] = H[:, :, nx:] = 0.0
        H[:, nx:, nx:] = decades(rng, recipe.input_weight_decades, (N + 1, 1, 1)) * np.eye(nu)
    if recipe.redundant:
        H[:, nx:, :nx] = 0.0
        H[:, :nx, nx:] = 0.0
        H[:, nx:, nx:] = decades(rng, (-2.0, 0.0), (N + 1, 1, 1))
    if recipe.outputs:
        H[:, (nx + 1) // 2 : nx] = 0.0
        H[:, :, (nx + 1) // 2 : nx] = 0.0
    return H[:, :nx, :nx].copy(), H[:-1, nx:, :nx].copy(), H[:-1, nx:, nx:].copy()


def _dynamics(rng: np.random.Generator, sizes: Sizes, recipe: Recipe) -> tuple[Floats, Floats]:
    """Return A, B."""
    N, nx, nu = sizes.stages, sizes.states, sizes.inputs
    base = rng.normal(size=(nx, nx))
    base *= rng.uniform(*recipe.growth) / np.abs(np.linalg.eigvals(base)).max()
    B = rng.normal(size=(N, nx, nu)) * decades(rng, recipe.steering_decades, (N, 1, 1))
    if recipe.redundant:
        B[:] = B[:, :, :1]
    if recipe.outputs:
        base[:, (nx + 1) // 2 :] = 0.0
    return base * (1.0 + 0.05 * rng.normal(size=(N, nx, nx))), B


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """Bounds around a point, with multipliers that suit it; every array is (NB,)."""

    bound: NDArray[np.int32]
    lower: Floats
    upper: Floats
    soft_linear: Floats
    soft_quadratic: Floats
    net: Floats
    """lower minus upper multiplier"""


def _places(rng: np.random.Generator, sizes: Sizes, recipe: Recipe) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Return bounded variables, each once and SPARE of them again, and which of them have bounds indeed."""
    N, nx, nu = sizes.stages, sizes.states, sizes.inputs
    given = 0 if sizes.free_initial else nx
    once = np.arange(given, (N + 1) * nx + N * nu)
    inputs = once >= (N + 1) * nx
    share = np.where(inputs, recipe.inputs_bounded, rng.uniform(*recipe.states_bounded))
    there = rng.random(once.size) < share
    if recipe.redundant:
        there &= ~inputs
    return np.concatenate([once, once[:SPARE] if once.size >= SPARE else np.resize(once, SPARE)]), np.concatenate(
        [there, np.zeros(SPARE, bool)]
    )


def _bounds(rng: np.random.Generator, sizes: Sizes, recipe: Recipe, z: Floats) -> Bounds:
    bound, there = _places(rng, sizes, recipe)
    n = bound.size
    value, states = z[bound], bound < (sizes.stages + 1) * sizes.states
    width = decades(rng, recipe.width_decades, n) * np.where(rng.random(n) < recipe.equal, 0.0, 1.0)
    side = np.where(rng.random(n) < 0.5, 1.0, -1.0) * (rng.random(n) < rng.uniform(*recipe.active))
    side[width == 0.0] = rng.choice([-1.0, 1.0], n)[width == 0.0]
    place = np.where(side == 0.0, rng.uniform(0.05, 0.95, n), side < 0.0)
    pull = decades(rng, recipe.multiplier_decades, n) * (rng.random(n) >= recipe.degenerate)
    net = side * pull * there
    lower, upper = value - place * width, value + (1.0 - place) * width
    lower[side > 0], upper[side < 0] = value[side > 0], value[side < 0]
    one_sided = rng.random(n) < 0.1
    lower[one_sided & (side < 0)], upper[one_sided & (side > 0)] = -np.inf, np.inf
    soft = states & there & (rng.random(n) < recipe.soft) & (width > 0.0)
    price = decades(rng, (-1.0, 3.0), n) * (not recipe.flat)
    growth = decades(rng, (-2.0, 2.0), n) * ((rng.random(n) < 0.5) | recipe.flat)
    given_way = soft & (side != 0.0) & (rng.random(n) < 0.5)
    beyond = np.where(given_way, decades(rng, (-2.0, 0.0), n), 0.0)
    net = np.where(given_way, side * (price + growth * beyond), np.where(soft, np.clip(net, -price, price), net))
    lower[given_way & (side > 0)] += beyond[given_way & (side > 0)]
    upper[given_way & (side > 0)] += beyond[given_way & (side > 0)]
    lower[given_way & (side < 0)] -= beyond[given_way & (side < 0)]
    upper[given_way & (side < 0)] -= beyond[given_way & (side < 0)]
    lower[~there], upper[~there] = -np.inf, np.inf
    found = Bounds(
        bound=bound.astype(np.int32),
        lower=lower,
        upper=upper,
        soft_linear=np.where(soft, price, np.inf),
        soft_quadratic=np.where(soft, growth, 0.0),
        net=net,
    )
    return _doubled(rng, found, there) if recipe.duplicates else found


def _doubled(rng: np.random.Generator, bounds: Bounds, there: NDArray[np.bool_]) -> Bounds:
    """Return the bounds with the SPARE last ones saying the same as others do, or looser."""
    hard = np.flatnonzero(there & np.isinf(bounds.soft_linear))
    again = rng.choice(hard, SPARE) if hard.size else np.zeros(SPARE, int)
    looser = rng.choice([0.0, 0.0, 1e-7, 0.5], SPARE)
    bound, lower, upper = bounds.bound.copy(), bounds.lower.copy(), bounds.upper.copy()
    bound[-SPARE:] = bound[again]
    if hard.size:
        lower[-SPARE:], upper[-SPARE:] = lower[again] - looser, upper[again] + looser
    return replace(bounds, bound=bound, lower=lower, upper=upper)


def _point(rng: np.random.Generator, sizes: Sizes, recipe: Recipe) -> Floats:
    """Return a point z (NZ,) that shall be optimal: states of size 1, inputs as far out as in the recipe."""
    N, nx, nu = sizes.stages, sizes.states, sizes.inputs
    far = decades(rng, recipe.reach_decades, (N, 1))
    return np.concatenate([rng.normal(size=(N + 1) * nx), (far * rng.normal(size=(N, nu))).ravel()])


def optimal_problem(rng: np.random.Generator, name: str, recipe: Recipe) -> HostileProblem:
    """Return a problem of the recipe, with its optimum."""
    sizes = recipe.sizes[rng.integers(len(recipe.sizes))]
    z = _point(rng, sizes, recipe)
    Q, S, R = _costs(rng, sizes, recipe)
    A, B = _dynamics(rng, sizes, recipe)
    bounds = _bounds(rng, sizes, recipe, z)
    scale = decades(rng, recipe.cost_decades)[0]
    net = np.zeros(z.size)
    np.add.at(net, bounds.bound, scale * bounds.net)
    draft = StageProblem(
        sizes=sizes,
        Q=scale * Q,
        S=scale * S,
        R=scale * R,
        A=A,
        B=B,
        c=np.zeros((sizes.stages, sizes.states)),
        g=np.zeros(z.size),
        initial=np.zeros(sizes.states),
        lower=bounds.lower,
        upper=bounds.upper,
        soft_linear=scale * bounds.soft_linear,
        soft_quadratic=scale * bounds.soft_quadratic,
        bound=bounds.bound,
    )
    pi = scale * rng.normal(size=(sizes.stages + 1, sizes.states))
    problem = with_optimum(draft, z, pi, net)
    if recipe.redundant:
        problem.g[-sizes.stages * sizes.inputs :] = np.repeat(problem.split(problem.g)[1][:, 0], sizes.inputs)
    x, u = (decades(rng, (-recipe.unit_decades, recipe.unit_decades), n) for n in (sizes.states, sizes.inputs))
    unit = np.concatenate([np.tile(x, sizes.stages + 1), np.tile(u, sizes.stages)])
    return HostileProblem(name=name, problem=problem.units(x, u), optimum=z * unit)
