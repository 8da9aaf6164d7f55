import math
import re
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest
from models import MODELS
from scipy.integrate import solve_ivp

from drawbar.errors import ModelError
from drawbar.geometry import Floats
from drawbar.vehicle.articulated import (
    articulated,
)
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.model import Model, constant, declare, symbols, variables
from drawbar.vehicle.parameters import VehicleParameters


def declared(**changes: Any) -> Model:
    """Return a cart on a line, with some of its declaration changed."""
    x, u = symbols(variables(position="m")), symbols(variables(speed="m/s"))
    whole = {
        "name": "cart",
        "states": variables(position="m"),
        "inputs": variables(speed="m/s"),
        "parameters": (),
        "outputs": variables(position="m"),
        "x": x,
        "u": u,
        "p": symbols(()),
        "derivative": u,
        "output": x,
    }
    return Model(**{**whole, **changes})


SYMBOL = ca.SX.sym("position")
TWICE = {"x": SYMBOL, "u": SYMBOL, "derivative": SYMBOL, "output": SYMBOL}


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"states": variables(position="m", yaw="rad")}, "declares 2 states"),
        ({"outputs": ()}, "declares 0 outputs"),
        ({"parameters": variables(slip="1")}, "declares 1 parameters"),
        ({"derivative": ca.SX(1, 2)}, "declares 1 states but the expression has shape (1, 2)"),
        ({"u": ca.SX.sym("u", 2)}, "declares 1 inputs"),
        ({"inputs": (), "u": ca.SX(0, 1), "derivative": ca.SX(1, 1)}, "at least one state and one input"),
        ({"derivative": ca.SX(math.sin(SYMBOL))}, "NaN in its expressions"),
        ({"derivative": ca.SX.sym("ghost")}, "neither state, input, parameter nor constant: ['ghost']"),
        ({"derivative": ca.SX.sym("position")}, "neither state, input, parameter nor constant: ['position']"),
        ({"inputs": variables(position="m/s")}, "declares 'position' more than once"),
        (
            {"outputs": 2 * variables(speed="m/s"), "output": ca.SX(2, 1)},
            "declares 'speed' more than once",
        ),
        ({"derivative": ca.MX.sym("speed")}, "the expression for its states is a MX, but must be CasADi's SX"),
        ({"p": ca.MX(0, 1)}, "the expression for its parameters is a MX"),
        ({"output": ca.DM(1.0)}, "put constants into ca.SX"),
        ({"x": 2.0 * SYMBOL, "output": SYMBOL}, "x, u, p, constants must be symbols"),
        (TWICE, "x, u, p, constants must be symbols, all different"),
        ({"constants": (constant("position", "m", 1.0),)}, "declares 'position' more than once"),
    ],
)
def test_declarations_that_do_not_fit_are_refused(changes: dict[str, Any], complaint: str) -> None:
    with pytest.raises(ModelError, match=re.escape(complaint)):
        declared(**changes)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_constant_that_is_not_finite_is_refused(value: float) -> None:
    with pytest.raises(ModelError, match="only finite numbers are allowed"):
        constant("length", "m", value)


def test_numeric_has_the_values_of_the_constants_that_the_equations_use() -> None:
    used, unused = constant("gain", "1", 3.0), constant("length", "m", 2.0)
    model = declare(
        "cart",
        states=variables(position="m"),
        inputs=variables(speed="m/s"),
        parameters=(),
        outputs=variables(position="m"),
        equations=lambda x, u, p: (used.symbol * u, x),
        constants=(used, unused),
    )
    assert model.constants == (used,)
    numeric = model.numeric()
    assert not numeric.constants
    assert float(ca.Function("f", [numeric.x, numeric.u], [numeric.derivative])(0.0, 5.0)) == 15.0
    assert float(ca.Function("F", [model.x, model.u], [integrate(model, 0.1)])(0.0, 5.0)) == pytest.approx(1.5)


@pytest.mark.parametrize("declare", MODELS)
def test_runge_kutta_has_order_four(declare: Callable[..., Model], draw: Callable[..., Any]) -> None:
    model = declare(VehicleParameters()).numeric()
    x, u, p = draw(model, np.random.default_rng(5))
    p[[v.name == "speed" for v in model.parameters]] = 3.0
    f = ca.Function("f", [model.x, model.u, model.p], [model.derivative])
    exact = solve_ivp(
        lambda _, y: np.array(f(y, u, p)).ravel(), (0.0, 1.0), x, method="DOP853", rtol=1e-13, atol=1e-13
    ).y[:, -1]

    def error(steps: int) -> float:
        step = ca.Function("F", [model.x, model.u, model.p], [integrate(model, 1.0, steps)])
        return float(np.abs(np.array(step(x, u, p)).ravel() - exact).max())

    assert np.log2(error(16) / error(32)) == pytest.approx(4.0, abs=0.15)


def test_steps_within_a_sample_are_samples_in_a_row(draw: Callable[..., Any]) -> None:
    model = articulated(VehicleParameters())
    x, u, p = draw(model, np.random.default_rng(6))
    once = ca.Function("F", [model.x, model.u, model.p], [integrate(model, 0.1)])
    both = ca.Function("F", [model.x, model.u, model.p], [integrate(model, 0.2, 2)])
    expected: Floats = np.array(once(once(x, u, p), u, p))
    np.testing.assert_allclose(np.array(both(x, u, p)), expected, atol=1e-14)
