"""Integration over one interval, as expressions: the classical Runge-Kutta method, and two for stiff models."""

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, Self

import casadi as ca

from drawbar.vehicle.model import Model

FIRST_SHARE = 0.25
"""of an interval, tried first by an adaptive integrator: the estimate of a step over all of it may be nil by chance"""
_DOUBLINGS = range(-3, 3)
"""of the length tried next, as the error allows; one less than the least where it is larger still"""


class Integrator(StrEnum):
    """How a model is carried over an interval."""

    RUNGE_KUTTA = "Runge-Kutta 4"
    """explicit, order 4, in steps of equal length; unstable where a step is longer than 2.7 times the model's shortest
    time constant"""
    ROSENBROCK = "Rodas3"
    """linearly implicit, order 3, for stiff models, in steps of equal length: what has died out within a step is zero
    after it"""
    ADAPTIVE = "adaptive Rodas3"
    """the same in as many steps as a tolerance asks for, short ones where the model is fast"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """One attempt at a step, as SX expressions of the model's u, p and constants and of the symbols x, left, length."""

    x: Any
    """(nx, 1) symbols: the state before"""
    left: Any
    """(1, 1) symbol: share of the interval that is left"""
    length: Any
    """(1, 1) symbol: share of the interval that is tried"""
    after: Any
    """(nx, 1) the state after the step"""
    taken: Any
    """(1, 1) 1 where its error is within the tolerance, else 0: the state stays"""
    remaining: Any
    """(1, 1) share of the interval that is left after it"""
    following: Any
    """(1, 1) share of the interval that is tried next"""
    most: int
    """attempts in an interval"""

    def with_input(self, u: Any, applied: Any) -> Self:
        """Return the attempt with an expression in the place of the model's inputs."""
        names = ("after", "taken", "remaining", "following")
        given = ca.substitute([getattr(self, name) for name in names], [u], [applied])
        return replace(self, **dict(zip(names, given, strict=True)))


def discretise(model: Model, interval: Any, steps: int, integrator: Integrator) -> Any:
    """Return x after one interval as an SX expression of x, u, p and the model's constants.

    Args:
        model: the model.
        interval: s, a number or a symbol; u and p are constant during it.
        steps: of the integrator within the interval.
        integrator: the method, one with steps of equal length.
    """
    method = {Integrator.RUNGE_KUTTA: runge_kutta, Integrator.ROSENBROCK: rosenbrock}[integrator]
    return method(model, interval, steps)


def integrate(model: Model, sample_time: float, steps: int = 1) -> Any:
    """Return x after one sample by the classical Runge-Kutta method of order 4, as an SX expression of x, u, p.

    Args:
        model: the model; its constants become numbers.
        sample_time: s, during which u and p are constant.
        steps: Runge-Kutta steps within the sample.
    """
    return runge_kutta(model.numeric(), sample_time, steps)


def runge_kutta(model: Model, sample_time: Any, steps: int = 1) -> Any:
    """Return x after one sample by the classical Runge-Kutta method of order 4, as an SX expression of x, u, p, c.

    Args:
        model: the model; its constants stay symbols, c.
        sample_time: s, a number or a symbol; u and p are constant during it.
        steps: Runge-Kutta steps within the sample.
    """
    f = ca.Function("f", [model.x, model.u, model.p, model.c], [model.derivative])
    h = sample_time / steps
    x = model.x
    for _ in range(steps):
        k1 = f(x, model.u, model.p, model.c)
        k2 = f(x + h / 2 * k1, model.u, model.p, model.c)
        k3 = f(x + h / 2 * k2, model.u, model.p, model.c)
        k4 = f(x + h * k3, model.u, model.p, model.c)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return x


def rosenbrock(model: Model, interval: Any, steps: int = 1) -> Any:
    """Return x after one interval by Rodas3 (Sandu et al. 1997, "Benchmarking stiff ODE solvers II", section 2.2).

    The method is L-stable and of order 3. Four linear systems with one matrix, I - h/2 df/dx, take the place of an
    iteration, so that a step is an expression with derivatives of its own. Its size grows with the cube of the number
    of states. Arguments and result: see discretise.
    """
    step, x = _rodas3(model), model.x
    for _ in range(steps):
        x, _error = step(x, model.u, model.p, model.c, interval / steps)
    return x


def attempt(model: Model, interval: Any, tolerance: Any, most: int) -> Attempt:
    """Return one attempt at a step of Rodas3, and how long the next one is to be.

    The error is proportional to the third power of the length; that of the next step is to be half of the tolerance.
    Lengths are halved and doubled, so that they add up to the interval without rounding. They follow from comparisons
    alone: their derivatives are zero.

    Args:
        model: the model.
        interval: s, a number or a symbol; u and p are constant during it.
        tolerance: of the estimated error of one step, root of the sum of squares over all states, each relative to one
            unit plus its size; a number or a symbol.
        most: attempts in an interval.
    """
    x, left, length = ca.SX.sym("carried", model.x.numel()), ca.SX.sym("left"), ca.SX.sym("length")
    share = ca.fmin(length, left)
    after, error = _rodas3(model)(x, model.u, model.p, model.c, share * interval)
    excess = ca.sumsqr(error / (tolerance * (1.0 + ca.fabs(x))))
    taken = excess <= 1.0
    longer = (2.0 ** (m - 1) * (excess <= 2.0 ** (-2 - 6 * m)) for m in _DOUBLINGS)
    return Attempt(
        x=x,
        left=left,
        length=length,
        after=after,
        taken=taken,
        remaining=left - ca.if_else(taken, share, 0.0),
        following=share * sum(longer, 2.0 ** (_DOUBLINGS[0] - 1)),
        most=most,
    )


def exact(model: Model, interval: float) -> ca.Function:
    """Return the function (x, u, p) -> x after an interval by CVODES: to simulate with, and to judge others by.

    CVODES (SUNDIALS, as CasADi brings it) takes as many steps, of orders 1 to 5, as its error control asks for, here
    for a relative error of 1e-12 in a step.

    Args:
        model: the model.
        interval: s, during which u and p are constant.
    """
    numeric, given = model.numeric(), ca.vertcat(model.u, model.p)
    problem = {"x": model.x, "p": given, "ode": numeric.derivative}
    carry = ca.integrator("carry", "cvodes", problem, 0.0, interval, {"abstol": 1e-13, "reltol": 1e-12})
    x, u, p = (ca.MX.sym(name, *symbol.shape) for name, symbol in (("x", model.x), ("u", model.u), ("p", model.p)))
    return ca.Function("exact", [x, u, p], [carry(x0=x, p=ca.vertcat(u, p))["xf"]])


def _rodas3(model: Model) -> ca.Function:
    """Return the function (x, u, p, constants, h) -> (x after h seconds, its distance from a method of order 2)."""
    arguments = [model.x, model.u, model.p, model.c]
    f = ca.Function("f", arguments, [model.derivative])
    jacobian = ca.Function("J", arguments, [ca.jacobian(model.derivative, model.x)])
    h, x, given = ca.SX.sym("h"), model.x, (model.u, model.p, model.c)
    solve = ca.inv(ca.SX.eye(x.numel()) - h / 2.0 * jacobian(x, *given))
    start = h / 2.0 * f(x, *given)
    k1 = ca.mtimes(solve, start)
    k2 = ca.mtimes(solve, start + 2.0 * k1)
    k3 = ca.mtimes(solve, h / 2.0 * f(x + 2.0 * k1, *given) + (k1 - k2) / 2.0)
    after = x + 2.0 * k1 + k3
    error = ca.mtimes(solve, h / 2.0 * f(after, *given) + (k1 - k2) / 2.0 - 4.0 / 3.0 * k3)
    return ca.Function("step", [*arguments, h], [after + error, error])
