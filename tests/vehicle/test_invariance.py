"""Mirror, rotate and shift the world: both models do not notice."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from models import MODELS

from drawbar.geometry import Floats
from drawbar.vehicle.model import Model, Variable
from drawbar.vehicle.parameters import VehicleParameters

Sample = Callable[..., tuple[Floats, Floats, Floats]]


def mirrored(group: tuple[Variable, ...], values: Floats) -> Floats:
    """Flip the y axis: y, lateral errors, angles, their rates and the curvature-like coupling change sign."""
    odd = [v.unit.startswith("rad") or v.name.endswith(("y", "lateral_error", "coupling")) for v in group]
    return np.where(odd, -values, values)


def moved(group: tuple[Variable, ...], values: Floats, angle: float, shift: Floats) -> Floats:
    """Rotate and shift positions (neighbouring x and y) and turn yaws."""
    result = values.copy()
    c, s = np.cos(angle), np.sin(angle)
    for i, v in enumerate(group):
        if v.name.endswith("yaw"):
            result[i] += angle
        if v.name.endswith("x") and v.unit == "m":
            result[i : i + 2] = np.array([[c, -s], [s, c]]) @ values[i : i + 2] + shift
    return result


@pytest.mark.parametrize("declare", MODELS)
def test_mirrored_states_move_mirrored(declare: Callable[..., Model], evaluate: Any, draw: Sample) -> None:
    model, rng = declare(VehicleParameters()), np.random.default_rng(1)
    for _ in range(20):
        point = draw(model, rng)
        there = tuple(
            mirrored(g, v) for g, v in zip((model.states, model.inputs, model.parameters), point, strict=True)
        )
        for group, expression in ((model.states, model.derivative), (model.outputs, model.output)):
            expected = mirrored(group, evaluate(model, expression, *point))
            np.testing.assert_allclose(evaluate(model, expression, *there), expected, atol=1e-12)


@pytest.mark.parametrize("declare", MODELS)
def test_turned_and_shifted_states_move_alike(declare: Callable[..., Model], evaluate: Any, draw: Sample) -> None:
    model, rng = declare(VehicleParameters()), np.random.default_rng(2)
    for _ in range(20):
        x, u, p = draw(model, rng)
        angle, shift = rng.uniform(-9, 9), rng.uniform(-50, 50, 2)
        there = moved(model.states, x, angle, shift), u, moved(model.parameters, p, angle, shift)
        turned = moved(model.states, evaluate(model, model.derivative, x, u, p), angle, np.zeros(2))
        turned -= np.where([s.name.endswith("yaw") for s in model.states], angle, 0.0)  # a yaw rate stays
        np.testing.assert_allclose(evaluate(model, model.derivative, *there), turned, atol=1e-12)
        outputs = moved(model.outputs, evaluate(model, model.output, x, u, p), angle, shift)
        np.testing.assert_allclose(evaluate(model, model.output, *there), outputs, atol=1e-11)
