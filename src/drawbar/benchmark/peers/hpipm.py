"""HPIPM (Frison and Diehl 2020) with BLASFEO, called in C: both are in CasADi's wheel."""

import ctypes
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drawbar.benchmark.peers.base import REPEATS, Bounds, Peer, bounds_of, casadi_library
from drawbar.benchmark.peers.call import TimedCall
from drawbar.codegen.library import aligned
from drawbar.geometry import Floats
from drawbar.optimal.stage_problem import StageProblem

_SPEED_ABS, _SPEED = 0, 1
"""enum hpipm_mode. The first is the faster one, but does not settle where bounds are soft."""
_BARRIER_HARD, _BARRIER_SOFT = 0.1, 1e4
"""where the barrier begins: the fastest of 0.1, 10, 100 and 1e4 with the right answer, by tries"""
_TOLERANCE = 1e-8
_ITERATIONS = 60


class Hpipm(Peer):
    """The interior point method on the stages as they are, a given first state eliminated."""

    name: ClassVar[str] = "HPIPM"
    timed: ClassVar[str] = "d_ocp_qp_ipm_solve to 1e-8, data in place; CasADi's BLASFEO (built for any processor)"

    def __init__(self, problem: StageProblem) -> None:
        """Lay out memory for problems like this one.

        Raises:
            MissingPeerError: CasADi's wheel has no HPIPM here.
        """
        self._library = casadi_library("hpipm")
        self._problem, self._memories = problem, list[NDArray[np.uint8]]()
        self._sizes = problem.sizes
        self._bounds = [bounds_of(problem, k) for k in range(self._sizes.stages + 1)]
        if not self._sizes.free_initial:
            none = np.array([], np.int64)
            first = self._bounds[0]
            self._bounds[0] = Bounds(state_rows=none, input_rows=first.input_rows, states=none, inputs=first.inputs)
        self._dim = self._make_dimensions()
        self._qp = self._make("d_ocp_qp", self._dim)
        self._solution = self._make("d_ocp_qp_sol", self._dim)
        self._arguments = self._make("d_ocp_qp_ipm_arg", self._dim)
        soft = bool(np.isfinite(problem.soft_linear).any())
        self._library.d_ocp_qp_ipm_arg_set_default(_SPEED if soft else _SPEED_ABS, self._arguments)
        for name in ("tol_stat", "tol_eq", "tol_ineq", "tol_comp"):
            self._option(name, ctypes.c_double(_TOLERANCE))
        self._option("mu0", ctypes.c_double(_BARRIER_SOFT if soft else _BARRIER_HARD))
        self._option("iter_max", ctypes.c_int(_ITERATIONS))
        self._work = self._make("d_ocp_qp_ipm_ws", self._dim, self._arguments)
        self._call = TimedCall(
            self._library.d_ocp_qp_ipm_solve, self._qp, self._solution, self._arguments, self._work, repeats=REPEATS
        )
        self._lay_down_structure()

    def solve(self, problem: StageProblem) -> tuple[float, Floats]:
        """Return the time of the solution alone, s, and z (NZ,)."""
        self._write(problem)
        return self._call.time(), self._read(problem)

    def _room(self, size: int) -> ctypes.c_void_p:
        self._memories.append(aligned(size))
        return ctypes.c_void_p(self._memories[-1].ctypes.data)

    def _size(self, name: str, *arguments: Any) -> int:
        function = getattr(self._library, name)
        function.restype = ctypes.c_size_t
        return int(function(*arguments))

    def _make(self, name: str, *arguments: Any) -> ctypes.c_void_p:
        """Return one of HPIPM's structures with its memory."""
        made = self._room(self._size(f"{name}_strsize"))
        memory = self._room(self._size(f"{name}_memsize", *arguments))
        getattr(self._library, f"{name}_create")(*arguments, made, memory)
        return made

    def _make_dimensions(self) -> ctypes.c_void_p:
        stages = self._sizes.stages
        made = self._make("d_ocp_qp_dim", ctypes.c_int(stages))
        for k, bounds in enumerate(self._bounds):
            soft = self._soft(bounds)
            numbers = {
                "nx": self._sizes.states if k or self._sizes.free_initial else 0,
                "nu": self._sizes.inputs if k < stages else 0,
                "nbx": len(bounds.states),
                "nbu": len(bounds.inputs),
                "ns": len(soft),
            }
            for name, number in numbers.items():
                self._library.d_ocp_qp_dim_set(name.encode(), k, number, made)
        return made

    def _soft(self, bounds: Bounds) -> NDArray[np.int64]:
        """Return which of a stage's bounds are soft, counted as HPIPM does: inputs, then states."""
        rows = np.concatenate([bounds.input_rows, bounds.state_rows])
        return np.flatnonzero(np.isfinite(self._problem.soft_linear[rows]))

    def _option(self, name: str, value: Any) -> None:
        self._library.d_ocp_qp_ipm_arg_set(name.encode(), ctypes.byref(value), self._arguments)

    def _set(self, stage: int, **values: ArrayLike) -> None:
        """Set fields of a stage; matrices are stored by columns."""
        for name, value in values.items():
            data: NDArray[Any] = np.asarray(value)
            kind = np.int32 if name.startswith("idx") else np.float64
            data = np.ascontiguousarray(data.T, kind)
            self._library.d_ocp_qp_set(name.encode(), stage, ctypes.c_void_p(data.ctypes.data), self._qp)

    def _lay_down_structure(self) -> None:
        for k, bounds in enumerate(self._bounds):
            self._set(k, idxbx=bounds.states, idxbu=bounds.inputs)
            soft = self._soft(bounds)
            if len(soft):
                rows = np.concatenate([bounds.input_rows, bounds.state_rows])[soft]
                linear, quadratic = self._problem.soft_linear[rows], self._problem.soft_quadratic[rows]
                zero = np.zeros(len(soft))
                self._set(k, idxs=soft, zl=linear, zu=linear, Zl=quadratic, Zu=quadratic, lls=zero, lus=zero)

    def _write(self, problem: StageProblem) -> None:
        stages, (x, u) = self._sizes.stages, problem.split(problem.g)
        for k in range(stages):
            self._set(k, A=problem.A[k], B=problem.B[k], b=problem.c[k])
            self._set(k, Q=problem.Q[k], S=problem.S[k], R=problem.R[k], q=x[k], r=u[k])
        self._set(stages, Q=problem.Q[stages], q=x[stages])
        if not self._sizes.free_initial:
            first = problem.initial
            self._set(0, b=problem.c[0] + problem.A[0] @ first, r=u[0] + problem.S[0] @ first)
        for k, bounds in enumerate(self._bounds):
            for of, rows in (("x", bounds.state_rows), ("u", bounds.input_rows)):
                for side, limit in (("l", problem.lower[rows]), ("u", problem.upper[rows])):
                    exists = np.isfinite(limit)
                    field = f"{side}b{of}"
                    self._set(k, **{field: np.where(exists, limit, 0.0), f"{field}_mask": exists.astype(float)})

    def _read(self, problem: StageProblem) -> Floats:
        status = ctypes.c_int()
        self._library.d_ocp_qp_ipm_get_status(self._work, ctypes.byref(status))
        if status.value != 0:
            return np.full(problem.g.size, np.nan)
        z = np.zeros(problem.g.size)
        x, u = problem.split(z)
        for get, values in ((self._library.d_ocp_qp_sol_get_x, x), (self._library.d_ocp_qp_sol_get_u, u)):
            for k, value in enumerate(values):
                get(k, self._solution, ctypes.c_void_p(value.ctypes.data))
        if not self._sizes.free_initial:
            x[0] = problem.initial
        return z
