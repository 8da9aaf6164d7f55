"""Stage problems of the quadratic program, drawn at random."""

from collections.abc import Callable

import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import Sizes
from drawbar.optimal.stage_problem import StageProblem


def _costs(rng: np.random.Generator, sizes: Sizes) -> tuple[Floats, Floats, Floats]:
    """Return Q, S, R: positive semidefinite together, a third of the stages of rank one in the states."""
    N, nx, n = sizes.stages, sizes.states, sizes.states + sizes.inputs
    root = rng.normal(size=(N + 1, n, n)) * rng.uniform(0.1, 2.0, (N + 1, 1, 1))
    root[rng.random(N + 1) < 0.3, 1:] = 0.0
    H = root.transpose(0, 2, 1) @ root
    H[:, nx:, nx:] += np.eye(n - nx) * rng.uniform(0.01, 1.0, (N + 1, 1, 1))
    Q = H[:, :nx, :nx].copy()
    if sizes.free_initial:
        Q[0] += 0.1 * np.eye(nx)
    return Q, H[:-1, nx:, :nx].copy(), H[:-1, nx:, nx:].copy()


def _bounds(rng: np.random.Generator, sizes: Sizes) -> tuple[np.ndarray, Floats, Floats]:
    """Return bounded variables and bounds: every input, then states; some one-sided, doubled or pinched."""
    first, last = (
        (sizes.stages + 1) * sizes.states,
        (sizes.stages + 1) * sizes.states + sizes.stages * sizes.inputs,
    )
    states = rng.permutation(np.arange(0 if sizes.free_initial else sizes.states, first))
    bound = np.concatenate([np.arange(first, last), states])[: sizes.bounds]
    middle = rng.normal(size=sizes.bounds) * 0.3
    width = rng.uniform(0.05, 2.0, sizes.bounds) * rng.choice([0.3, 1.0, 5.0])
    lower, upper = middle - width, middle + width
    lower[rng.random(sizes.bounds) < 0.1] = -np.inf
    upper[rng.random(sizes.bounds) < 0.1] = np.inf
    if rng.random() < 0.3:  # the last one says the same as the first, or says it looser
        looser = rng.choice([0.0, 0.5])
        bound[-1], lower[-1], upper[-1] = bound[0], lower[0] - looser, upper[0] + looser
    if rng.random() < 0.2:
        pinched = rng.integers(0, sizes.stages * sizes.inputs)
        lower[pinched] = upper[pinched] = middle[pinched]
        if bound[-1] == bound[pinched]:
            lower[-1], upper[-1] = middle[pinched] - 0.1, middle[pinched] + 0.1
    return bound, lower, upper


@pytest.fixture(scope="session")
def stage_problem() -> Callable[[np.random.Generator, Sizes], StageProblem]:
    """Return a random problem of the given sizes; state bounds are all hard or all soft."""

    def stage_problem(rng: np.random.Generator, sizes: Sizes) -> StageProblem:
        N, nx, nu = sizes.stages, sizes.states, sizes.inputs
        Q, S, R = _costs(rng, sizes)
        bound, lower, upper = _bounds(rng, sizes)
        soft = (bound < (N + 1) * nx) & (rng.random() < 0.6)
        return StageProblem(
            sizes=sizes,
            Q=Q,
            S=S,
            R=R,
            A=np.eye(nx) + 0.3 * rng.normal(size=(N, nx, nx)),
            B=rng.normal(size=(N, nx, nu)),
            c=rng.normal(size=(N, nx)) * 0.1,
            g=rng.normal(size=(N + 1) * nx + N * nu),
            initial=rng.normal(size=nx) * 0.5,
            bound=bound.astype(np.int32),
            lower=lower,
            upper=upper,
            soft_linear=np.where(soft, rng.choice([0.5, 10.0, 1000.0]), np.inf),
            soft_quadratic=np.where(soft, rng.choice([0.0, 1.0, 100.0]), 0.0),
        )

    return stage_problem
