"""Base of every peer: a solver of stage problems of one structure that reports how long it took."""

import ctypes
from abc import ABC, abstractmethod
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import ClassVar

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from drawbar.codegen import Workspace
from drawbar.errors import DrawbarError
from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import Sizes
from drawbar.optimal.stage_problem import StageProblem

REPEATS = 5
"""solutions of one problem, of which the shortest time counts"""


class MissingPeerError(DrawbarError):
    """A peer is not on this machine, and why."""


class Peer(ABC):
    """A solver made for the structure of one problem: sizes, bounded variables, and which bounds exist and are soft."""

    name: ClassVar[str]
    timed: ClassVar[str]
    """what its time is of"""

    @abstractmethod
    def __init__(self, problem: StageProblem) -> None:
        """Lay out memory for problems like this one.

        Raises:
            MissingPeerError: the peer is not on this machine.
        """

    @abstractmethod
    def solve(self, problem: StageProblem) -> tuple[float, Floats]:
        """Return the time to solve it, s, and its z (NZ,); NaN where there is none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """The bounded variables of one stage by their places in x and u."""

    state_rows: NDArray[np.int64]
    """which of the problem's bounds are on states of this stage"""
    input_rows: NDArray[np.int64]
    states: NDArray[np.int64]
    """which states these are"""
    inputs: NDArray[np.int64]


def bounds_of(problem: StageProblem, stage: int) -> Bounds:
    """Return the bounds on variables of a stage, in the order of their variables."""
    nx, nu = problem.sizes.states, problem.sizes.inputs
    first = (problem.sizes.stages + 1) * nx
    order = np.argsort(problem.bound)
    at = problem.bound[order]
    on_state, on_input = (at < first) & (at // nx == stage), (at >= first) & ((at - first) // nu == stage)
    return Bounds(
        state_rows=order[on_state],
        input_rows=order[on_input],
        states=at[on_state] % nx,
        inputs=(at[on_input] - first) % nu,
    )


def stage_problem(workspace: Workspace, *, free_initial: bool) -> StageProblem:
    """Return a copy of the problem that a solver has just solved, its constant states like all others."""
    fields = ("Q", "R", "A", "B", "c", "g", "initial", "lower", "upper", "soft_linear", "soft_quadratic", "bound")
    data = {name: workspace.array(f"qp.{name}").copy() for name in fields}
    stages, moving, nx = data["A"].shape
    nu = data["B"].shape[2]
    constant = np.broadcast_to(np.eye(nx)[moving:], (stages, nx - moving, nx))
    cross = workspace.array("qp.S")
    return StageProblem(
        sizes=Sizes(stages=stages, states=nx, inputs=nu, bounds=len(data["bound"]), free_initial=free_initial),
        S=cross.copy() if len(cross) else np.zeros((stages, nu, nx)),
        **data
        | {
            "A": np.concatenate([data["A"], constant], axis=1),
            "B": np.concatenate([data["B"], np.zeros((stages, nx - moving, nu))], axis=1),
        },
    )


def casadi_library(name: str) -> ctypes.CDLL:
    """Load a shared library that CasADi's wheel ships.

    Raises:
        MissingPeerError: it ships none, or one that cannot be loaded.
    """
    folder = Path(ca.__file__).parent
    found = [file for suffix in ("so", "dylib", "dll") for file in folder.glob(f"*{name}.{suffix}")]
    own = [file for file in found if file.stem in (name, f"lib{name}")]
    if not own:
        raise MissingPeerError(f"CasADi {version('casadi')} has no {name} here")
    try:
        return ctypes.CDLL(str(own[0]))
    except OSError as error:
        raise MissingPeerError(f"CasADi's {name} cannot be loaded ({error})") from error
