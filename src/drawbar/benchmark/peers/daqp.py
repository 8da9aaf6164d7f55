"""DAQP (Arnström, Bemporad and Axehill 2022), called in C: it is in CasADi's wheel."""

import ctypes
from typing import Any, ClassVar

import numpy as np

from drawbar.benchmark.peers.base import REPEATS, Peer, casadi_library
from drawbar.benchmark.peers.call import TimedCall
from drawbar.geometry import Floats
from drawbar.optimal.stage_problem import StageProblem

_CURVATURE = 1e-3
"""of the penalty of a violation: DAQP wants a definite cost, and so much changes it by less than a millionth"""
_UNBOUNDED = 1e30
_LATER = ("room", ctypes.c_double * 64)
"""for fields that newer versions put at the end"""


class _Problem(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_int) for name in ("n", "m", "ms")),
        *((name, ctypes.c_void_p) for name in ("H", "f", "A", "bupper", "blower", "sense")),
        _LATER,
    )


class _Result(ctypes.Structure):
    _fields_ = (
        ("x", ctypes.c_void_p),
        ("lam", ctypes.c_void_p),
        ("fval", ctypes.c_double),
        ("soft_slack", ctypes.c_double),
        ("exitflag", ctypes.c_int),
        _LATER,
    )


class _Settings(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_double) for name in ("primal_tol", "dual_tol", "zero_tol", "pivot_tol", "progress_tol")),
        _LATER,
    )


class Daqp(Peer):
    """The dual active set on the condensed problem: inputs (and a free first state) alone."""

    name: ClassVar[str] = "DAQP"
    timed: ClassVar[str] = "daqp_quadprog on the condensed problem; condensing is not counted"

    def __init__(self, problem: StageProblem) -> None:
        """Lay out memory for problems like this one.

        Raises:
            MissingPeerError: CasADi's wheel has no DAQP here.
        """
        self._library = casadi_library("daqp")
        self._problem, self._result, self._settings = _Problem(), _Result(), _Settings()
        self._library.daqp_default_settings(ctypes.byref(self._settings))
        self._settings.primal_tol = 1e-9
        self._data: dict[str, Any] = {}
        given = (ctypes.byref(each) for each in (self._result, self._problem, self._settings))
        self._call = TimedCall(self._library.daqp_quadprog, *given, repeats=REPEATS)

    def solve(self, problem: StageProblem) -> tuple[float, Floats]:
        """Return the time from the condensed problem to its solution, s, and z (NZ,)."""
        data = _condensed(problem)
        T, t = data.pop("T"), data.pop("t")
        n, m = len(data["f"]), len(data["bupper"])
        own, program = T.shape[1], self._problem
        program.n, program.m, program.ms = n, m, 0
        self._data = {**data, "sense": np.zeros(m, np.int32), "x": np.zeros(n), "lam": np.zeros(m)}  # C keeps no copy
        for name in ("H", "f", "A", "bupper", "blower", "sense"):
            setattr(program, name, self._data[name].ctypes.data)
        self._result.x, self._result.lam = self._data["x"].ctypes.data, self._data["lam"].ctypes.data
        time = self._call.time()
        solved = self._result.exitflag == 1
        return time, T @ self._data["x"][:own] + t if solved else np.full(len(t), np.nan)


def _condensed(problem: StageProblem) -> dict[str, Floats]:
    """Return H, f, A, blower, bupper over (v, violations), where z = T v + t."""
    T, t = problem.reach()
    soft = np.flatnonzero(np.isfinite(problem.soft_linear))
    own, m = T.shape[1], 2 * len(soft)
    H, f = np.zeros((own + m, own + m)), np.zeros(own + m)
    H[:own, :own] = T.T @ np.apply_along_axis(problem.weighed, 0, T)
    f[:own] = T.T @ (problem.weighed(t) + problem.g)
    H[own:, own:] = np.diag(np.tile(problem.soft_quadratic[soft] + _CURVATURE * problem.soft_linear[soft], 2))
    f[own:] = np.tile(problem.soft_linear[soft], 2)
    rows = T[problem.bound]
    lower, upper = problem.lower - t[problem.bound], problem.upper - t[problem.bound]
    hard = np.isinf(problem.soft_linear)
    sides = np.zeros((m, own + m))
    sides[:, :own], sides[:, own:] = np.tile(rows[soft], (2, 1)), np.diag(np.repeat([1.0, -1.0], len(soft)))
    A = np.concatenate([np.pad(rows[hard], ((0, 0), (0, m))), sides, np.eye(m, own + m, own)])
    none = np.full(len(soft), np.inf)
    blower = np.concatenate([lower[hard], lower[soft], -none, np.zeros(m)])
    bupper = np.concatenate([upper[hard], none, upper[soft], np.tile(none, 2)])
    blower, bupper = (np.clip(side, -_UNBOUNDED, _UNBOUNDED) for side in (blower, bupper))
    return {"T": T, "t": t, "H": H, "f": f, "A": A, "blower": blower, "bupper": bupper}
