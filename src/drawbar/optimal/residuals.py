"""Residuals: how far a trajectory is from the optimum of its nonlinear problem, and what a solve found."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.signals import SolverStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class Residuals:
    """The largest of each kind of optimality condition, in the problem's own units; zero at the optimum."""

    stationarity: float
    """of the gradient of the Lagrangian with respect to states and inputs; half the sum of squares is the cost"""
    defect: float
    """of F(x_k, u_k, p_k) - x_{k+1}, and of x_0 from a given first state"""
    violation: float
    """of hard bounds"""
    complementarity: float
    """of a bound's multiplier times the distance from it"""

    @property
    def largest(self) -> float:
        """The largest of all; NaN where one is."""
        return float(np.max([self.stationarity, self.defect, self.violation, self.complementarity]))


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """What a solve found; arrays are copies, which later samples do not change."""

    status: SolverStatus
    """of the last quadratic program"""
    solved: bool
    """every residual is within the tolerance"""
    steps: int
    """Gauss-Newton steps taken"""
    x: Floats
    """(M+1, nx) states"""
    u: Floats
    """(N, nu) inputs"""
    residuals: Residuals


def residuals(array: Callable[[str], Floats], free_initial: bool) -> Residuals:
    """Return the residuals along a solver's trajectory, linearised there, with the multipliers of its last program.

    Args:
        array: the solver's fields, by name.
        free_initial: the first state is a variable.
    """
    x, pi, g = array("x"), array("qp.pi"), array("qp.g")
    states, rows = x.size, array("qp.A").shape[1]
    constant = np.eye(x.shape[1])[rows:]
    # the Lagrangian's gradient without bounds: g + (dF/dz)' pi_{k+1} - pi_k
    gradient = g.copy()
    along, across = gradient[:states].reshape(x.shape), gradient[states:].reshape(array("u").shape)
    along[:-1] += np.einsum("kij,ki->kj", array("qp.A"), pi[1:, :rows]) + pi[1:, rows:] @ constant
    across += np.einsum("kia,ki->ka", array("qp.B"), pi[1:, :rows])
    along[1:] -= pi[1:]
    bound: NDArray[np.intp] = array("qp.bound").astype(np.intp)
    multiplier = array("qp.multiplier").reshape(-1, 2)
    np.add.at(gradient, bound, multiplier[:, 1] - multiplier[:, 0])
    if not free_initial:
        along[0] = 0.0
    value = np.concatenate([x.ravel(), array("u").ravel()])[bound]
    distance = np.column_stack([value - array("lower"), array("upper") - value])
    soft = np.isfinite(array("qp.soft_linear"))
    outside = np.maximum(-distance, 0.0)
    slack = np.where(soft[:, None], outside, 0.0)
    active = multiplier != 0.0
    penalty = array("qp.soft_linear")[soft, None] + array("qp.soft_quadratic")[soft, None] * slack[soft]
    given = np.zeros(0) if free_initial else array("initial") - x[0]
    return Residuals(
        stationarity=_largest(gradient),
        defect=_largest(np.append(array("qp.c"), given)),
        violation=_largest(outside - slack),
        complementarity=_largest(
            np.append(multiplier[active] * (distance + slack)[active], (penalty - multiplier[soft]) * slack[soft])
        ),
    )


def _largest(values: Floats) -> float:
    return float(np.abs(values).max(initial=0.0))
