"""Error models from declared vehicle models: Jacobians by CasADi, discretised exactly for what is held over a sample.

The sources of disturbance are the model's own parameters, each as the error of what the nominal model assumes for the
sample, and one additive rate for each state for all that no parameter can describe.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from drawbar.control.tube.error_model import ErrorModel
from drawbar.geometry import Floats
from drawbar.vehicle.model import Model, with_values

_ORDER = 18
"""Of the series; its rest is below the rounding error."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandedModel:
    """A vehicle model whose input is replaced by what the steering command makes of it."""

    model: Model
    errors: Mapping[str, str]
    """names of the errors that count, and the model's states they belong to; the others are not controlled"""
    command: Any
    """SX symbol, rad"""
    derivative: Any
    """(nx, 1) SX of the model's x, p and the command"""


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingPoint:
    """Where to linearise; what is not named is zero."""

    states: Mapping[str, float]
    parameters: Mapping[str, float]
    command: float


def linearised(commanded: CommandedModel, points: Sequence[OperatingPoint], sample_time: float) -> ErrorModel:
    """Return the error model over one sample (s) at the operating points, in the frame of a nominal heading of zero."""
    model, jacobians = commanded.model, _jacobians(commanded)
    n, known = len(commanded.errors), len(model.parameters)
    system = _discretised(np.array([_at(jacobians, model, point) for point in points]), sample_time)
    units = {state.name: state.unit for state in model.states}
    of_errors = tuple(units[state] for state in commanded.errors.values())
    # what is given for the stage, the reference and the tractor's pose, moves no state
    acting = [j for j in range(known) if system[:, :, n + 1 + j].any()]
    rates = list(range(known, known + n))
    return ErrorModel(
        states=tuple(commanded.errors),
        units=of_errors,
        A=system[:, :, :n],
        B=system[:, :, n],
        disturbances=(*(model.parameters[j].name for j in acting), *(f"{name}_rate" for name in commanded.errors)),
        disturbance_units=(*(model.parameters[j].unit for j in acting), *(f"{unit}/s" for unit in of_errors)),
        G=system[:, :, [n + 1 + j for j in (*acting, *rates)]],
    )


def _jacobians(commanded: CommandedModel) -> ca.Function:
    """Return the derivatives of the errors' rates by errors, command and parameters: (n, n + 1 + np)."""
    model = commanded.model
    names = [state.name for state in model.states]
    kept = [names.index(state) for state in commanded.errors.values()]
    rates = commanded.derivative[kept]
    by = (model.x[kept], commanded.command, model.p)
    together = ca.horzcat(*(ca.jacobian(rates, symbol) for symbol in by))
    return ca.Function("jacobians", [model.x, commanded.command, model.p], with_values([together], model.constants))


def _at(jacobians: ca.Function, model: Model, point: OperatingPoint) -> Floats:
    """Return the jacobians (n, n + 1 + np) at an operating point, and unit columns for the additive rates."""
    x = [point.states.get(state.name, 0.0) for state in model.states]
    p = [point.parameters.get(parameter.name, 0.0) for parameter in model.parameters]
    continuous = np.array(jacobians(x, point.command, p))
    return np.hstack([continuous, np.eye(len(continuous))])


def _discretised(continuous: Floats, sample_time: float) -> Floats:
    """Return what x' = [A, G] (x, w) becomes over a sample with w held, for A (v, n, n) and G (v, n, m) side by side.

    That is exp(A T), and the integral of exp(A t) over the sample times G: by the series over a fraction of the sample,
    which is then doubled (Moler and Van Loan 2003, method 3).
    """
    n = continuous.shape[1]
    A, G, unit = continuous[:, :, :n], continuous[:, :, n:], np.eye(n)
    doublings = max(0, math.ceil(math.log2(1.0 + 2.0 * sample_time * float(np.abs(A).sum(axis=2).max()))))
    step = sample_time / 2**doublings
    series = unit
    for order in range(_ORDER, 1, -1):
        series = unit + step / order * A @ series
    integral = step * series
    for _ in range(doublings):
        integral = integral @ (2.0 * unit + A @ integral)
    return np.concatenate([unit + A @ integral, integral @ G], axis=2)
