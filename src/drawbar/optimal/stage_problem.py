"""Stage problem: one structured quadratic program as data, beside its dense form; qp.h has the formula."""

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes


@dataclass(frozen=True, slots=True, kw_only=True)
class StageProblem:
    """One structured quadratic program as numpy arrays, named as in the workspace.

    Variables z are x_0 .. x_N, then u_0 .. u_{N-1}: NZ = (N+1) NX + N NU.
    """

    sizes: Sizes
    Q: Floats
    """(N+1, NX, NX)"""
    S: Floats
    """(N, NU, NX)"""
    R: Floats
    """(N, NU, NU)"""
    A: Floats
    """(N, NX, NX)"""
    B: Floats
    """(N, NX, NU)"""
    c: Floats
    """(N, NX)"""
    g: Floats
    """(NZ,)"""
    initial: Floats
    """(NX,) the first state where it is given"""
    lower: Floats
    """(NB,) infinite where there is none"""
    upper: Floats
    """(NB,)"""
    soft_linear: Floats
    """(NB,) linear penalty of a violation; infinite where the bound is hard"""
    soft_quadratic: Floats
    """(NB,) quadratic penalty"""
    bound: NDArray[np.int32]
    """(NB,) index into z of each bounded variable"""

    def into(self, program: QuadraticProgram) -> None:
        """Fill the compiled program's arrays."""
        for field in fields(self)[1:]:
            program.array(field.name)[:] = getattr(self, field.name)

    def hessian(self) -> Floats:
        """Return the dense H (NZ, NZ) of 1/2 z'Hz + g'z."""
        N, nx, nu = self.sizes.stages, self.sizes.states, self.sizes.inputs
        H, first = np.zeros((self.g.size, self.g.size)), (N + 1) * nx
        for k in range(N + 1):
            x, u = slice(k * nx, (k + 1) * nx), slice(first + k * nu, first + (k + 1) * nu)
            H[x, x] = self.Q[k]
            if k < N:
                H[u, u], H[u, x], H[x, u] = self.R[k], self.S[k], self.S[k].T
        return H

    def dynamics(self) -> tuple[Floats, Floats]:
        """Return E (N NX, NZ), e of E z = e: row block k is A_k x_k + B_k u_k - x_{k+1} = -c_k."""
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

    def split(self, z: Floats) -> tuple[Floats, Floats]:
        """Return x (N+1, NX) and u (N, NU) as views into z."""
        N, nx, nu = self.sizes.stages, self.sizes.states, self.sizes.inputs
        return z[: (N + 1) * nx].reshape(N + 1, nx), z[(N + 1) * nx :].reshape(N, nu)

    def weighed(self, z: Floats) -> Floats:
        """Return H z (NZ,) by stages."""
        x, u = self.split(z)
        crossed = np.einsum("kaj,ka->kj", self.S, u)
        state = np.einsum("kij,kj->ki", self.Q, x)
        state[:-1] += crossed
        force = np.einsum("kab,kb->ka", self.R, u) + np.einsum("kaj,kj->ka", self.S, x[:-1])
        return np.concatenate([state.ravel(), force.ravel()])

    def defects(self, z: Floats) -> Floats:
        """Return A x + B u + c - x_next (N, NX)."""
        x, u = self.split(z)
        moved: Floats = np.einsum("kij,kj->ki", self.A, x[:-1]) + np.einsum("kia,ka->ki", self.B, u)
        return moved + self.c - x[1:]

    def violations(self, z: Floats) -> Floats:
        """Return by how much z lies outside each lower and upper bound (2, NB), soft ones included."""
        value = z[self.bound]
        return np.maximum([self.lower - value, value - self.upper], 0.0)

    def penalty(self, z: Floats) -> float:
        """Return the penalty of the violations of soft bounds at a point (NZ,)."""
        soft = np.isfinite(self.soft_linear)
        outside = self.violations(z)[:, soft]
        return float((self.soft_linear[soft] * outside + 0.5 * self.soft_quadratic[soft] * outside**2).sum())

    def units(self, x: Floats, u: Floats) -> "StageProblem":
        """Return the same problem with state j in units of 1/x[j], x (NX,), and input a in units of 1/u[a], u (NU,)."""
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
