"""The structured quadratic program before two independent judges: an interior point and an active-set method.

The judges get the states eliminated and every slack explicit, in well-scaled units; drawbar gets the stages, on every
other problem in units from 1e-3 to 1e3.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import clarabel
import numpy as np
import piqp
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


@dataclass(frozen=True, slots=True)
class Verdict:
    """What a judge says: feasible or not, and the optimal cost."""

    feasible: bool
    cost: float


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


def clarabel_verdict(P: Floats, q: Floats, G: Floats, h: Floats, constant: float) -> Verdict:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    upper = sparse.triu(sparse.csc_matrix(P), format="csc")
    cone = [clarabel.NonnegativeConeT(len(h))]
    found = clarabel.DefaultSolver(upper, q, sparse.csc_matrix(G), h, cone, settings).solve()
    feasible = found.status in (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)
    return Verdict(feasible, found.obj_val + constant)


def piqp_verdict(P: Floats, q: Floats, G: Floats, h: Floats, constant: float) -> Verdict:
    solver = piqp.DenseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = 1e-10
    solver.settings.eps_duality_gap_abs = solver.settings.eps_duality_gap_rel = 1e-10
    solver.setup(P, q, None, None, G, None, h)
    status = solver.solve()
    return Verdict(status == piqp.PIQP_SOLVED, solver.result.info.primal_obj + constant)
