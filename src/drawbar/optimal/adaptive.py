"""An adaptive integrator as C: one attempt at a step with its derivatives, and what the steps come to (adaptive.h)."""

from dataclasses import dataclass
from typing import Any

import casadi as ca

from drawbar.codegen.emit import Output, emit
from drawbar.codegen.statements import Input
from drawbar.optimal.frame import ADAPTIVE, CARRIED, WORK
from drawbar.vehicle.integrators import FIRST_SHARE, Attempt

_STAGES = "(N + LEAVING)"


@dataclass(frozen=True, slots=True, kw_only=True)
class Way:
    """What an attempt changes: the state, its derivative, what is left of the interval, the length to try."""

    attempt: Attempt
    before: Any
    """(n, 1) SX symbols: state (nx, 1), derivative (nx, columns) by rows, left, length"""
    after: Any
    """(n, 1) SX: the same after the attempt"""
    slope: Any
    """(nx, nz) SX: the derivative with respect to all of the stage's variables z = (x, u)"""
    columns: int
    """elements of z on which the state depends; the model's states are the first"""

    @property
    def read(self) -> Input:
        """Where generated functions find it."""
        return Input(place="carried[{k} - first][{i}]", rows=_STAGES, symbol=self.before)

    def text(self, inputs: list[Input], dynamics: list[Output]) -> str:
        """Return C: the function dynamics.

        Args:
            inputs: of all functions of a stage, `read` among them.
            dynamics: what is made of the state at the interval's end, and of its derivative.
        """
        tried = [Output(place="carried[k - first]", rows=_STAGES, value=self.after)]
        sizes = {"attempts": self.attempt.most, "states": self.attempt.x.numel(), "columns": self.columns}
        return (
            ADAPTIVE.format(**sizes, first=FIRST_SHARE)
            + emit("attempt", inputs, tried, f"const {WORK}, {CARRIED}")
            + emit("arrive", inputs, dynamics, f"{WORK}, const {CARRIED}")
        )


def way_of(attempt: Attempt, z: Any) -> Way:
    """Return how an attempt changes the state and its derivative.

    Args:
        attempt: in terms of z and of its own symbols.
        z: (nz, 1) SX symbols of the stage's variables, of which the first are the model's states.
    """
    nx = attempt.x.numel()
    direct = ca.jacobian(attempt.after, z)
    columns = sorted({*range(nx), *direct.sparsity().get_triplet()[1]})
    by_rows = ca.SX.sym("slope", len(columns) * nx)
    slope = ca.reshape(by_rows, len(columns), nx).T
    moved = ca.mtimes(ca.jacobian(attempt.after, attempt.x), slope) + direct[:, columns]
    whole = ca.SX(nx, z.numel())
    whole[:, columns] = slope
    return Way(
        attempt=attempt,
        before=ca.vertcat(attempt.x, by_rows, attempt.left, attempt.length),
        after=ca.vertcat(
            attempt.x + ca.if_else(attempt.taken, attempt.after - attempt.x, 0.0),
            by_rows + ca.if_else(attempt.taken, ca.vec(moved.T) - by_rows, 0.0),
            attempt.remaining,
            attempt.following,
        ),
        slope=whole,
        columns=len(columns),
    )
