"""Stage problems of the quadratic program, drawn at random, in dense form, and as independent judges see them."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes


@dataclass(frozen=True, slots=True, kw_only=True)
class StageProblem:
    """One structured quadratic program as numpy arrays, named as in the workspace."""

    sizes: Sizes
    Q: Floats
    S: Floats
    R: Floats
    A: Floats
    B: Floats
    c: Floats
    g: Floats
    initial: Floats
    lower: Floats
    upper: Floats
    soft_linear: Floats
    soft_quadratic: Floats
    bound: np.ndarray

    def into(self, program: QuadraticProgram) -> None:
        """Fill the compiled program's arrays."""
        for name in self.__slots__[1:]:
            program.array(name)[:] = getattr(self, name)

    def hessian(self) -> Floats:
        """Return the dense H of 1/2 z'Hz + g'z."""
        N, nx, nu = self.sizes.stages, self.sizes.states, self.sizes.inputs
        H, first = np.zeros((self.g.size, self.g.size)), (N + 1) * nx
        for k in range(N + 1):
            x, u = slice(k * nx, (k + 1) * nx), slice(first + k * nu, first + (k + 1) * nu)
            H[x, x] = self.Q[k]
            if k < N:
                H[u, u], H[u, x], H[x, u] = self.R[k], self.S[k], self.S[k].T
        return H

    def dynamics(self) -> tuple[Floats, Floats]:
        """Return E, e of E z = e: row block k is A_k x_k + B_k u_k - x_{k+1} = -c_k."""
        N, nx, nu = self.sizes.stages, self.sizes.states, self.sizes.inputs
        E, first = np.zeros((N, nx, self.g.size)), (N + 1) * nx
        for k in range(N):
            E[k, :, k * nx : (k + 1) * nx] = self.A[k]
            E[k, :, first + k * nu : first + (k + 1) * nu] = self.B[k]
            E[k, :, (k + 1) * nx : (k + 2) * nx] = -np.eye(nx)
        return E.reshape(N * nx, -1), -self.c.ravel()

    def reach(self) -> tuple[Floats, Floats]:
        """Return T, t of z = T v + t, where v is (x_0 if free, every u): the states eliminated."""
        N, nx, nu = self.sizes.stages, self.sizes.states, self.sizes.inputs
        own = nx if self.sizes.free_initial else 0
        T, t = np.zeros((self.g.size, own + N * nu)), np.zeros(self.g.size)
        T[:own, :own] = np.eye(own)
        t[: nx - own] = self.initial[: nx - own]
        T[(N + 1) * nx :, own:] = np.eye(N * nu)
        for k in range(N):
            x, following = slice(k * nx, (k + 1) * nx), slice((k + 1) * nx, (k + 2) * nx)
            u = slice(own + k * nu, own + (k + 1) * nu)
            T[following] = self.A[k] @ T[x]
            T[following, u] += self.B[k]
            t[following] = self.A[k] @ t[x] + self.c[k]
        return T, t

    def units(self, x: Floats, u: Floats) -> "StageProblem":
        """Return the same problem with state j in units of 1/x[j] and input a in units of 1/u[a]."""
        N = self.sizes.stages
        z = np.concatenate([np.tile(x, N + 1), np.tile(u, N)])
        own = z[self.bound]
        return replace(
            self,
            Q=self.Q / np.outer(x, x),
            S=self.S / np.outer(u, x),
            R=self.R / np.outer(u, u),
            A=self.A * np.outer(x, 1 / x),
            B=self.B * np.outer(x, 1 / u),
            c=self.c * x,
            g=self.g / z,
            initial=self.initial * x,
            lower=self.lower * own,
            upper=self.upper * own,
            soft_linear=self.soft_linear / own,
            soft_quadratic=self.soft_quadratic / own**2,
        )


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
