"""Stage problems that follow a reference within boxes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import Sizes
from drawbar.optimal.stage_problem import StageProblem


@dataclass(frozen=True, slots=True)
class Box:
    """Bounds of one state or input of one stage."""

    of_input: bool
    stage: int
    index: int
    lower: float
    upper: float

    @classmethod
    def state(cls, stage: int, index: int, lower: float, upper: float) -> "Box":
        """Return the bounds of a state."""
        return cls(False, stage, index, float(lower), float(upper))

    @classmethod
    def input(cls, stage: int, index: int, lower: float, upper: float) -> "Box":
        """Return the bounds of an input."""
        return cls(True, stage, index, float(lower), float(upper))


def tracking_problem(
    A: Floats, B: Floats, Q: Floats, R: Floats, target: Floats, initial: Floats, boxes: Sequence[Box]
) -> StageProblem:
    """Return the problem with the cost 1/2 sum |x_k - target_k|^2_{Q_k} + |u_k|^2_R.

    Args:
        A: (NX, NX), or one for each stage.
        B: (NX, NU), likewise.
        Q: (N+1, NX, NX).
        R: (NU, NU).
        target: (N+1, NX).
        initial: (NX,) the given first state.
        boxes: one for each bounded variable.
    """
    stages, nx, nu = len(Q) - 1, B.shape[-2], B.shape[-1]
    first_input = (stages + 1) * nx
    bound = [first_input + box.stage * nu + box.index if box.of_input else box.stage * nx + box.index for box in boxes]
    return StageProblem(
        sizes=Sizes(stages=stages, states=nx, inputs=nu, bounds=len(boxes), free_initial=False),
        Q=Q,
        S=np.zeros((stages, nu, nx)),
        R=np.repeat(R[None], stages, axis=0),
        A=np.broadcast_to(A, (stages, nx, nx)).copy(),
        B=np.broadcast_to(B, (stages, nx, nu)).copy(),
        c=np.zeros((stages, nx)),
        g=np.concatenate([-np.einsum("kij,kj->ki", Q, target).ravel(), np.zeros(stages * nu)]),
        initial=initial,
        lower=np.array([box.lower for box in boxes]),
        upper=np.array([box.upper for box in boxes]),
        soft_linear=np.full(len(boxes), np.inf),
        soft_quadratic=np.zeros(len(boxes)),
        bound=np.array(bound, np.int32),
    )
