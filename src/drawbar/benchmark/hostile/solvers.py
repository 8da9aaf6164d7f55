"""drawbar's quadratic program and its peers behind one call: a problem in, an answer out."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from scipy import sparse

from drawbar.benchmark.hostile.verdict import Answer, Verdict
from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes
from drawbar.optimal.stage_problem import StageProblem
from drawbar.signals import SolverStatus

Solver = Callable[[StageProblem], Answer]
_CLAIMS = {SolverStatus.SOLVED: Verdict.SOLVED, SolverStatus.INFEASIBLE: Verdict.INFEASIBLE}
_PEER_TOLERANCE = 1e-9
_DENSE_LIMIT = 400
"""variables beyond which DAQP, which is dense, is not tried"""


@cache
def _program(sizes: Sizes) -> QuadraticProgram:
    return QuadraticProgram(sizes)


def drawbar(problem: StageProblem) -> Answer:
    """Solve by the solver that is under every controller and estimator."""
    program = _program(problem.sizes)
    problem.into(program)
    claim = _CLAIMS.get(program.solve(), Verdict.GIVEN_UP)
    return Answer(claim=claim, z=program.array("z").copy())


class _Sparse:
    """A stage problem as min 1/2 w'Pw + q'w, Ew = e, Gw <= h; w is z and a violation for each side of a soft bound."""

    def __init__(self, problem: StageProblem) -> None:
        n, bound = problem.g.size, problem.bound
        sides = [(sign, i) for sign, limit in ((-1.0, problem.lower), (1.0, problem.upper)) for i in _finite(limit)]
        soft = [(row, i) for row, (_, i) in enumerate(sides) if np.isfinite(problem.soft_linear[i])]
        rows, m = len(sides), len(soft)
        slack_rows, slack_of = np.array([row for row, _ in soft], int), np.array([i for _, i in soft], int)
        index = np.array([i for _, i in sides], int)
        sign = np.array([sign for sign, _ in sides])
        E, e = problem.dynamics()
        if not problem.sizes.free_initial:
            nx = problem.sizes.states
            E, e = np.vstack([np.eye(nx, n), E]), np.concatenate([problem.initial, e])
        self.P = sparse.block_diag(
            [sparse.csc_matrix(problem.hessian()), sparse.diags(problem.soft_quadratic[slack_of])], format="csc"
        )
        self.q = np.concatenate([problem.g, problem.soft_linear[slack_of]])
        scale = max(np.abs(self.q).max(), np.abs(self.P).max(), 1e-300)  # their tolerances are absolute
        self.P, self.q = self.P / scale, self.q / scale
        self.E, self.e = sparse.csc_matrix(np.hstack([E, np.zeros((len(e), m))])), e
        G = sparse.lil_matrix((rows + m, n + m))
        G[np.arange(rows), bound[index]] = sign
        G[slack_rows, n + np.arange(m)] = -1.0
        G[rows + np.arange(m), n + np.arange(m)] = -1.0
        limit = np.where(sign < 0, -problem.lower[index], problem.upper[index])
        self.G, self.h, self.n = G.tocsc(), np.concatenate([limit, np.zeros(m)]), n


def _finite(limit: Floats) -> list[int]:
    return [int(i) for i in np.flatnonzero(np.isfinite(limit))]


def clarabel(problem: StageProblem) -> Answer:
    """Solve by Clarabel."""
    import clarabel  # type: ignore[import-untyped]

    s = _Sparse(problem)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = _PEER_TOLERANCE
    cones = [clarabel.ZeroConeT(s.e.size), clarabel.NonnegativeConeT(s.h.size)]
    rows = sparse.vstack([s.E, s.G], format="csc")
    limits = np.concatenate([s.e, s.h])
    found = clarabel.DefaultSolver(sparse.triu(s.P, format="csc"), s.q, rows, limits, cones, settings).solve()
    if found.status == clarabel.SolverStatus.Solved:
        return Answer(claim=Verdict.SOLVED, z=np.array(found.x)[: s.n])
    infeasible = found.status == clarabel.SolverStatus.PrimalInfeasible
    return Answer(claim=Verdict.INFEASIBLE if infeasible else Verdict.GIVEN_UP)


def piqp(problem: StageProblem) -> Answer:
    """Solve by PIQP's sparse solver."""
    import piqp  # type: ignore[import-untyped]

    s = _Sparse(problem)
    solver = piqp.SparseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = _PEER_TOLERANCE
    solver.settings.eps_duality_gap_abs = solver.settings.eps_duality_gap_rel = _PEER_TOLERANCE
    solver.setup(s.P, s.q, s.E, s.e, s.G, None, s.h)
    status = solver.solve()
    if status == piqp.PIQP_SOLVED:
        return Answer(claim=Verdict.SOLVED, z=np.array(solver.result.x)[: s.n])
    infeasible = status == piqp.PIQP_PRIMAL_INFEASIBLE
    return Answer(claim=Verdict.INFEASIBLE if infeasible else Verdict.GIVEN_UP)


def daqp(problem: StageProblem) -> Answer:
    """Solve by DAQP, with the states kept as variables and the dynamics as equations."""
    import daqp

    s = _Sparse(problem)
    if s.q.size > _DENSE_LIMIT:
        return Answer(claim=Verdict.GIVEN_UP)
    rows = np.vstack([s.E.toarray(), s.G.toarray()])
    upper = np.concatenate([s.e, s.h])
    lower = np.concatenate([s.e, np.full(s.h.size, -1e30)])
    sense = np.concatenate([np.full(s.e.size, 5), np.zeros(s.h.size)]).astype(np.int32)
    settings: dict[str, Any] = {"eps_prox": 1e-6, "primal_tol": 1e-9, "iter_limit": 10000}
    z, _, flag, _ = daqp.solve(s.P.toarray(), s.q, rows, upper, lower, sense, **settings)
    if flag == 1:
        return Answer(claim=Verdict.SOLVED, z=np.array(z)[: s.n])
    return Answer(claim=Verdict.INFEASIBLE if flag == -1 else Verdict.GIVEN_UP)


SOLVERS: dict[str, Solver] = {"drawbar": drawbar, "clarabel": clarabel, "piqp": piqp, "daqp": daqp}
