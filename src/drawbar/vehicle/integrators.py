"""Integration over one sample, as expressions: the classical Runge-Kutta method, and one for stiff models."""

from enum import StrEnum
from typing import Any

import casadi as ca

from drawbar.vehicle.model import Model, runge_kutta


class Integrator(StrEnum):
    """How a model is carried over a sample; both in steps of equal length, their number given beside it."""

    RUNGE_KUTTA = "Runge-Kutta 4"
    """explicit, order 4; unstable where a step is longer than 2.7 times the model's shortest time constant"""
    ROSENBROCK = "Rodas3"
    """linearly implicit, order 3, for stiff models: what has died out within a step is zero after it"""


def discretise(model: Model, sample_time: Any, steps: int, integrator: Integrator) -> Any:
    """Return x after one sample as an SX expression of x, u, p and the model's constants.

    Args:
        model: the model.
        sample_time: s, a number or a symbol; u and p are constant during it.
        steps: of the integrator within the sample.
        integrator: the method.
    """
    method = {Integrator.RUNGE_KUTTA: runge_kutta, Integrator.ROSENBROCK: rosenbrock}[integrator]
    return method(model, sample_time, steps)


def rosenbrock(model: Model, sample_time: Any, steps: int = 1) -> Any:
    """Do the same by Rodas3 (Sandu et al. 1997, "Benchmarking stiff ODE solvers II", section 2.2), L-stable, order 3.

    Four linear systems with one matrix, I/(h/2) - df/dx, take the place of an iteration, so that a step is an
    expression with derivatives of its own. Its size grows with the cube of the number of states.
    """
    arguments = [model.x, model.u, model.p, model.c]
    f = ca.Function("f", arguments, [model.derivative])
    jacobian = ca.Function("J", arguments, [ca.jacobian(model.derivative, model.x)])
    h = sample_time / steps
    x, given = model.x, (model.u, model.p, model.c)
    for _ in range(steps):
        solve = ca.inv(2.0 / h * ca.SX.eye(x.numel()) - jacobian(x, *given))
        slope = f(x, *given)
        k1 = ca.mtimes(solve, slope)
        k2 = ca.mtimes(solve, slope + 4.0 / h * k1)
        k3 = ca.mtimes(solve, f(x + 2.0 * k1, *given) + (k1 - k2) / h)
        after = x + 2.0 * k1 + k3
        x = after + ca.mtimes(solve, f(after, *given) + (k1 - k2 - 8.0 / 3.0 * k3) / h)
    return x
