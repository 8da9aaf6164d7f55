"""Files of quadratic programs, as `qpsolvers.Problem.save` writes them, read as one dense stage."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space

from drawbar.benchmark.published.families import Published
from drawbar.errors import SolverError
from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import Sizes
from drawbar.optimal.stage_problem import StageProblem

_CONTRADICTION = 1e-9
"""of the largest number in question; equations farther from being fulfilled contradict each other"""
_ROUNDING = 1e-12
"""of a row's largest number; a row that no variable moves by more is a constant"""
_NO_POINT = "The equations of {file} contradict each other or a bound: no point obeys all of them. Leave it out."


def problems_in(folder: Path) -> Iterator[Published]:
    """Return the problems of all .npz files of a folder.

    Raises:
        SolverError: there is no such file.
    """
    files = sorted(folder.glob("*.npz"))
    if not files:
        raise SolverError(f"{folder} holds no .npz files. Give the data folder of a copy of mpc_qpbenchmark.")
    for file in files:
        yield Published(name=file.stem, family=file.stem.rstrip("0123456789"), problem=read_problem(file))


def read_problem(file: Path) -> StageProblem:
    """Return min 1/2 u'Pu + q'u, Gu <= h, Au = b, lb <= u <= ub as one stage.

    Equations, fixed variables among them, are eliminated: u = Z v + u0 with AZ = 0, A u0 = b. The inputs are v, the
    last state is what has bounds, x_1 = [G; I] Z v. The constant of the cost is left out.

    Raises:
        SolverError: the equations contradict each other or a bound.
    """
    with np.load(file, allow_pickle=False) as saved:
        P, q = saved["P"], saved["q"]
        n = q.size
        G, A = (_optional(saved, key, np.zeros((0, n))) for key in ("G", "A"))
        h, b = (_optional(saved, key, np.zeros(0)) for key in ("h", "b"))
        lb, ub = _optional(saved, "lb", np.full(n, -np.inf)), _optional(saved, "ub", np.full(n, np.inf))
    fixed, boxed = lb == ub, (lb < ub) & (np.isfinite(lb) | np.isfinite(ub))
    Z, u0 = _without(np.vstack([A, np.eye(n)[fixed]]), np.concatenate([b, lb[fixed]]), file)
    rows = np.vstack([G, np.eye(n)[boxed]])
    lower = np.concatenate([np.full(h.size, -np.inf), lb[boxed]]) - rows @ u0
    upper = np.concatenate([h, ub[boxed]]) - rows @ u0
    rows, lower, upper = _that_move(rows, lower, upper, Z, u0, file)
    m, n = len(rows), Z.shape[1]
    return StageProblem(
        sizes=Sizes(stages=1, states=m, inputs=n, bounds=m, free_initial=False),
        Q=np.zeros((2, m, m)),
        S=np.zeros((1, n, m)),
        R=(Z.T @ P @ Z)[None],
        A=np.zeros((1, m, m)),
        B=(rows @ Z)[None],
        c=np.zeros((1, m)),
        g=np.concatenate([np.zeros(2 * m), Z.T @ (P @ u0 + q)]),
        initial=np.zeros(m),
        lower=lower,
        upper=upper,
        soft_linear=np.full(m, np.inf),
        soft_quadratic=np.zeros(m),
        bound=np.arange(m, 2 * m, dtype=np.int32),
    )


def _that_move(
    rows: Floats, lower: Floats, upper: Floats, Z: Floats, u0: Floats, file: Path
) -> tuple[Floats, Floats, Floats]:
    """Return lower <= rows Z v <= upper without the rows that no v moves; a stage has one state at least."""
    moved = np.abs(rows @ Z).max(axis=1, initial=0.0) > _ROUNDING * np.abs(rows).max(axis=1)
    excess = max(lower[~moved].max(initial=0.0), -upper[~moved].min(initial=0.0))
    if excess > _CONTRADICTION * np.abs(u0).max(initial=1.0):
        raise SolverError(_NO_POINT.format(file=file))
    if not moved.any():
        return np.zeros((1, rows.shape[1])), np.array([-np.inf]), np.array([np.inf])
    return rows[moved], lower[moved], upper[moved]


def _without(A: Floats, b: Floats, file: Path) -> tuple[Floats, Floats]:
    """Return Z, u0 of u = Z v + u0, all solutions of the equations."""
    u0: Floats = np.asarray(np.linalg.lstsq(A, b, rcond=None)[0], float)
    if np.abs(A @ u0 - b).max(initial=0.0) > _CONTRADICTION * np.abs(b).max(initial=1.0):
        raise SolverError(_NO_POINT.format(file=file))
    Z: Floats = null_space(A) if len(A) else np.eye(A.shape[1])
    return Z, u0


def _optional(saved: Mapping[str, NDArray[Any]], key: str, without: Floats) -> Floats:
    """Return an array that may be missing: None was saved as an object, which is not read."""
    try:
        return np.asarray(saved[key], float)
    except ValueError:
        return without
