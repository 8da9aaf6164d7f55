"""Numbers for the models: evaluation of their expressions and random operating points."""

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.vehicle.model import Model, with_values

LARGEST = {
    "rad": 0.5,
    "rad/s": 0.3,
    "m": 30.0,
    "m/s": 3.0,
    "1": 1.0,
}
"""magnitude of random values by unit"""


@pytest.fixture(scope="session")
def evaluate() -> Callable[..., Floats]:
    """Return the value of an expression of a model at x, u, p, flat."""

    def evaluate(model: Model, expression: Any, x: Floats, u: Floats, p: Floats) -> Floats:
        values = with_values([ca.densify(expression)], model.constants)
        function = ca.Function("value", [model.x, model.u, model.p], values)
        return np.array(function(x, u, p)).ravel()

    return evaluate


@pytest.fixture(scope="session")
def draw() -> Callable[..., tuple[Floats, Floats, Floats]]:
    """Return random states, inputs and parameters of a model; yaws are anywhere within a turn and a half."""

    def draw(model: Model, rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
        groups = (model.states, model.inputs, model.parameters)
        x, u, p = (
            np.array(
                [
                    rng.uniform(0.3, 1.0)
                    if variable.name.endswith("_slip")
                    else rng.uniform(-1, 1) * (9.0 if variable.name.endswith("yaw") else LARGEST[variable.unit])
                    for variable in group
                ]
            )
            for group in groups
        )
        return x, u, p

    return draw
