"""The same problem by another route: CasADi linearisation, dense condensing in numpy, DAQP; plain as in textbooks.

Condensing (Bock and Plitt 1984): with the states eliminated, dx_k = drift_k + transfer_k dx_0 + response_k xi, what
remains is a small dense quadratic program in xi = (dx_0 where it is free, all du).
"""

from dataclasses import replace

import casadi as ca
import numpy as np

from drawbar.geometry import Floats
from drawbar.optimal import ControlSolver, EstimationSolver
from drawbar.optimal.solver_source import LEVENBERG
from drawbar.optimal.transcription import Transcription, transcribe

_UNBOUNDED = 1e30
"""DAQP's infinity."""


def transcription_now(solver: ControlSolver | EstimationSolver) -> Transcription:
    """Return a solver's transcription with its constants as they are now: an estimator learns some while driving."""
    made = transcribe(solver.problem)
    values = solver.workspace.array("constants")
    now = [replace(each, value=float(value)) for each, value in zip(made.constants, values, strict=True)]
    return replace(made, constants=tuple(now))


class CondensingRoute:
    """One real-time iteration from a solver's present trajectory and data, which are only read."""

    def __init__(self, transcription: Transcription, solver: ControlSolver | EstimationSolver) -> None:
        """Make the CasADi functions of all stages."""
        t = self._transcription = transcription.numeric()
        self._solver, self._array = solver, solver.workspace.array
        z = ca.vertcat(t.x, t.u)
        dynamics = ca.Function("dynamics", [t.x, t.u, t.p], [t.next_state, ca.jacobian(t.next_state, z)])
        output = ca.Function("output", [t.x, t.u, t.p], [t.output, ca.jacobian(t.output, z)])
        self._dynamics, self._output = dynamics.map(t.intervals), output.map(t.intervals + 1)
        self._nx, self._nu = t.x.numel(), t.u.numel()
        self._first = self._nx if t.free_initial else 0
        self._size = self._first + t.intervals * self._nu

    def prepare(self) -> None:
        """Linearise along the trajectory and condense the Hessian."""
        x, u = self._solver.x, self._solver.u
        p = self._solver.p if isinstance(self._solver, ControlSolver) else np.zeros((len(x), 0))
        step, slope = (np.array(m) for m in self._dynamics(x[:-1].T, u.T, p[:-1].T))
        h, jacobian = (np.array(m) for m in self._output(x.T, np.vstack([u, u[-1:]]).T, p.T))
        self._condense_dynamics(self._by_stage(slope), step.T - x[1:])
        self._h = h.T
        self._condense_outputs(self._by_stage(jacobian))
        self._weigh()

    def feedback(self) -> Floats:
        """Solve with the newest data and return the step xi (size,)."""
        import daqp  # the test extra has it

        solver, horizon = self._solver, self._transcription.intervals
        offset = self._drift.copy()
        if not self._first:
            offset += self._transfer @ (self._array("initial") - solver.x[0])
        residual = self._h + np.einsum("kij,kj->ki", self._C, offset) - np.nan_to_num(solver.y)
        gradient = self._G.T @ (self._weights * residual).ravel()
        if self._first:
            root = self._array("root")
            gradient[: self._nx] += root.T @ (root @ (solver.x[0] - self._array("prior")))
        rows, lower, upper = [], [], []
        now = np.concatenate([solver.x.ravel(), solver.u.ravel()])
        states = (horizon + 1) * self._nx
        for (index, _), low, high in zip(
            self._transcription.bounds, self._array("lower"), self._array("upper"), strict=True
        ):
            row, moved = np.zeros(self._size), 0.0
            if index < states:
                stage, j = divmod(index, self._nx)
                row, moved = self._response[stage, j], offset[stage, j]
            else:
                row[self._first + index - states] = 1.0
            rows.append(row)
            lower.append(low - now[index] - moved)
            upper.append(high - now[index] - moved)
        matrix = np.array(rows).reshape(-1, self._size)
        limits = (np.clip(side, -_UNBOUNDED, _UNBOUNDED) for side in (np.array(upper), np.array(lower)))
        step: Floats = daqp.solve(self._H, gradient, matrix, *limits, np.zeros(len(rows), np.int32))[0]
        return step

    def _by_stage(self, wide: Floats) -> Floats:
        """Return CasADi's matrices side by side as (stages, rows, nx + nu)."""
        return wide.reshape(wide.shape[0], -1, self._nx + self._nu).swapaxes(0, 1)

    def _columns(self, stage: int) -> slice:
        """Return where this stage's input is in xi."""
        return slice(self._first + stage * self._nu, self._first + (stage + 1) * self._nu)

    def _condense_dynamics(self, slope: Floats, defect: Floats) -> None:
        horizon, nx = self._transcription.intervals, self._nx
        self._drift, self._transfer = np.zeros((horizon + 1, nx)), np.zeros((horizon + 1, nx, nx))
        self._response = np.zeros((horizon + 1, nx, self._size))
        self._transfer[0], self._response[0, :, : self._first] = np.eye(nx), np.eye(nx)[:, : self._first]
        for k in range(horizon):
            A, B = slope[k, :, :nx], slope[k, :, nx:]
            self._drift[k + 1] = A @ self._drift[k] + defect[k]
            self._transfer[k + 1] = A @ self._transfer[k]
            self._response[k + 1] = A @ self._response[k]
            self._response[k + 1, :, self._columns(k)] += B

    def _condense_outputs(self, jacobian: Floats) -> None:
        self._C = jacobian[:, :, : self._nx]
        response = self._C @ self._response
        for k in range(self._transcription.intervals):
            response[k, :, self._columns(k)] += jacobian[k, :, self._nx :]
        self._G = response.reshape(-1, self._size)

    def _weigh(self) -> None:
        solver = self._solver
        self._weights = np.where(np.isnan(solver.y), 0.0, solver.w)
        self._H = self._G.T @ (self._weights.ravel()[:, None] * self._G)
        self._H[self._first :, self._first :] += LEVENBERG * np.eye(self._size - self._first)
        if self._first:
            root = self._array("root")
            self._H[: self._nx, : self._nx] += root.T @ root
