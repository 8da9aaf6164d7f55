"""PIQP (Schwan, Jiang, Kuhn and Jones 2023), its multistage backend, from its Python wheel, by its own clock."""

from typing import Any, ClassVar

import numpy as np
from scipy import sparse

from drawbar.benchmark.peers.base import REPEATS, MissingPeerError, Peer
from drawbar.geometry import Floats
from drawbar.optimal.stage_problem import StageProblem

_TOLERANCE = 1e-11
"""with less its answers are further from the others' than a millionth"""


class Piqp(Peer):
    """The proximal interior point method on the stages as they are."""

    name: ClassVar[str] = "PIQP"
    timed: ClassVar[str] = "update and solve of the sparse_multistage backend, by PIQP's own clock"

    def __init__(self, problem: StageProblem) -> None:
        """Take PIQP from its wheel.

        Raises:
            MissingPeerError: it is not installed, or has no multistage backend.
        """
        try:
            import piqp  # type: ignore[import-untyped]  # a test extra, needed nowhere else

            self._backend = piqp.KKTSolver.sparse_multistage
        except ImportError as error:
            raise MissingPeerError("piqp is not installed; the extra `test` brings it") from error
        except AttributeError as error:
            raise MissingPeerError(f"piqp {piqp.__version__} has no multistage backend") from error
        self._piqp: Any = piqp
        self._form = _Form(problem)
        self._solver: Any = None

    def solve(self, problem: StageProblem) -> tuple[float, Floats]:
        """Return the time of update and solution, s, and z (NZ,)."""
        data = self._form.of(problem)
        if self._solver is None:
            self._solver = self._piqp.SparseSolver()
            settings = self._solver.settings
            settings.kkt_solver, settings.compute_timings = self._backend, True
            settings.eps_abs = settings.eps_rel = _TOLERANCE
            self._solver.setup(*data)
        times, info = [], self._solver.result.info
        for _ in range(REPEATS):
            self._solver.update(*data)
            status = self._solver.solve()
            times.append(info.update_time + info.solve_time)
        if status != self._piqp.PIQP_SOLVED:
            return min(times), np.full(problem.g.size, np.nan)
        return min(times), np.array(self._solver.result.x)[self._form.place]


class _Form:
    """A stage problem over w, stage by stage (x_k, u_k, violations): min 1/2 w'Pw + q'w, E w = e, rows, box."""

    def __init__(self, problem: StageProblem) -> None:
        n, nx, nu = problem.g.size, problem.sizes.states, problem.sizes.inputs
        first = (problem.sizes.stages + 1) * nx
        self._soft = np.flatnonzero(np.isfinite(problem.soft_linear))
        at = problem.bound[self._soft]
        stage = np.concatenate([np.arange(first) // nx, np.arange(n - first) // nu, *2 * [at_stage(at, first, nx, nu)]])
        self._size = len(stage)
        self.place = np.argsort(np.argsort(stage, kind="stable"), kind="stable")[:n]
        """(NZ,) where each variable of z is in w"""
        self._order = np.argsort(stage, kind="stable")
        ones = {name: np.ones_like(getattr(problem, name)) for name in ("Q", "S", "R", "A", "B")}
        pattern = StageProblem(**{**{f: getattr(problem, f) for f in StageProblem.__slots__}, **ones})
        self._patterns = [matrix != 0.0 for matrix in self._matrices(pattern)]

    def _matrices(self, problem: StageProblem) -> list[Floats]:
        """Return P, E and the rows of soft bounds, dense, variables in stage order."""
        n, m, nx = problem.g.size, self._size - problem.g.size, problem.sizes.states
        P = np.zeros((self._size, self._size))
        P[:n, :n] = problem.hessian()
        P[n:, n:] = np.diag(np.tile(problem.soft_quadratic[self._soft], 2))
        E = np.pad(problem.dynamics()[0], ((0, 0), (0, m)))
        if not problem.sizes.free_initial:
            E = np.concatenate([np.eye(nx, self._size), E])
        G = np.zeros((m, self._size))
        G[np.arange(m), np.tile(problem.bound[self._soft], 2)] = 1.0
        G[:, n:] = np.diag(np.repeat([1.0, -1.0], len(self._soft)))
        return [P[np.ix_(self._order, self._order)], E[:, self._order], G[:, self._order]]

    def of(self, problem: StageProblem) -> tuple[Any, ...]:
        """Return P, q, E, e, G, its sides, and the box, as PIQP's setup takes them."""
        P, E, G = (
            sparse.csc_matrix((matrix[pattern.nonzero()], pattern.nonzero()), matrix.shape)
            for matrix, pattern in zip(self._matrices(problem), self._patterns, strict=True)
        )
        soft, m = self._soft, self._size - problem.g.size
        none = np.full(len(soft), np.inf)
        box = [np.concatenate([np.full(problem.g.size, side), limit]) for side, limit in _violations(m)]
        hard = np.isinf(problem.soft_linear)
        box[0][problem.bound[hard]], box[1][problem.bound[hard]] = problem.lower[hard], problem.upper[hard]
        e = problem.dynamics()[1]
        if not problem.sizes.free_initial:
            e = np.concatenate([problem.initial, e])
        q = np.concatenate([problem.g, np.tile(problem.soft_linear[soft], 2)])[self._order]
        sides = np.concatenate([problem.lower[soft], -none]), np.concatenate([none, problem.upper[soft]])
        rows = (G, *sides) if m else (None, None, None)
        return P, q, E, e, *rows, *(side[self._order] for side in box)


def at_stage(at: Any, first: int, nx: int, nu: int) -> Any:
    """Return the stages of variables of z."""
    return np.where(at < first, at // nx, (at - first) // nu)


def _violations(count: int) -> list[tuple[float, Floats]]:
    return [(-np.inf, np.zeros(count)), (np.inf, np.full(count, np.inf))]
