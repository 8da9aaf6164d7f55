"""The chain against its own constraints and closed forms (docs/theory/vehicle-models.md)."""

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.vehicle.articulated import articulated, articulated_trailer
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.model import Model
from drawbar.vehicle.parameters import VehicleParameters

TINY = 1e-40
"""Step of the complex-step derivative: no cancellation, so exact to rounding."""


def trailer_axle(vehicle: VehicleParameters, x: Any) -> Any:
    """Position of the trailer axle from the geometry of docs/theory/conventions.md, as numpy."""
    theta, psi, phi = x[2], x[3], x[3] + x[5]
    ahead = (vehicle.free_joint_offset, theta), (vehicle.drawbar_length, phi), (vehicle.trailer_length, psi)
    east = x[0] - sum(length * np.cos(angle) for length, angle in ahead)
    north = x[1] - sum(length * np.sin(angle) for length, angle in ahead)
    return np.array([east, north])


def along_and_across(velocity: Floats, yaw: float) -> tuple[float, float]:
    c, s = np.cos(yaw), np.sin(yaw)
    return c * velocity[0] + s * velocity[1], c * velocity[1] - s * velocity[0]


def test_both_axles_slide_by_their_side_slip_angles(evaluate: Any, draw: Any) -> None:
    vehicle = VehicleParameters()
    model, rng = articulated(vehicle), np.random.default_rng(3)
    for _ in range(200):
        x, u, p = draw(model, rng)
        mu, _, _, trailer_crab, v, crab = p
        derivative = evaluate(model, model.derivative, x, u, p)
        along, across = along_and_across(derivative[:2], x[2])
        assert along == pytest.approx(mu * v, abs=1e-12)
        assert across == pytest.approx(mu * v * np.tan(crab), abs=1e-12)
        velocity = trailer_axle(vehicle, x + 1j * TINY * derivative).imag / TINY
        along, across = along_and_across(velocity, x[3])
        assert across == pytest.approx(along * np.tan(trailer_crab), abs=1e-9)


def test_outputs_are_antennas_and_hitch_angle(evaluate: Any, draw: Any) -> None:
    vehicle = VehicleParameters()
    model = articulated(vehicle)
    x, u, p = draw(model, np.random.default_rng(4))
    forward = np.array([np.cos(x[3]), np.sin(x[3])])
    antenna = trailer_axle(vehicle, x) + vehicle.trailer_antenna * forward
    expected = [x[0], x[1], *antenna, x[2] - x[3] - x[5], p[4], x[4], x[5], *u]
    np.testing.assert_allclose(evaluate(model, model.output, x, u, p), expected, atol=1e-13)


def test_steering_the_joint_left_moves_the_trailer_right_by_a_first_order_lag() -> None:
    vehicle = VehicleParameters(trailer_antenna=0.0)
    model, speed = articulated(vehicle).numeric(), 1.3
    z = ca.vertcat(model.x, model.u)
    slopes = ca.Function(
        "slopes", [z, model.p], [ca.jacobian(model.derivative, z), ca.jacobian(model.output[3], model.x)]
    )
    f, c = (np.array(m) for m in slopes(np.zeros(8), [1.0, 1.0, 0.0, 0.0, speed, 0.0]))
    a, b, d = f[:, :6], f[:, 7], vehicle.drawbar_length
    for s in (1e-6 + 0j, 0.3 + 1j, 2 - 5j, 40j):
        rate_response = c @ np.linalg.solve(s * np.eye(6) - a, b)
        angle_response = s * rate_response[0]  # the input is the angle's rate
        lag = (vehicle.trailer_length + d) * s + speed
        assert angle_response == pytest.approx(-speed * d / lag, rel=1e-9)


def settled(model: Model, rho: float, joint: float) -> Floats:
    """Return the state after a minute on a left circle of radius rho at 1 m/s with a constant joint angle."""
    steering = np.arctan(1.4 / rho)
    step = ca.Function("F", [model.x, model.u, model.p], [integrate(model, 0.1)]).mapaccum(600)
    x = np.array([0.0, 0.0, 0.0, -1.6 / rho, steering, joint])
    return np.array(step(x, np.zeros(2), [1, 1, 0, 0, 1, 0]))[:, -1]


@pytest.mark.parametrize("rho", [6.67, 10.0, 40.0])
@pytest.mark.parametrize("joint", [-0.35, 0.0, 0.2])
def test_circle_radius_of_the_trailer(rho: float, joint: float) -> None:
    vehicle = VehicleParameters()
    x = settled(articulated(vehicle), rho, joint)
    centre = x[:2] + rho * np.array([-np.sin(x[2]), np.cos(x[2])])
    d, a = vehicle.drawbar_length, vehicle.free_joint_offset
    lever = vehicle.trailer_length + d * np.cos(joint)
    expected = d * np.sin(joint) + np.sqrt(rho**2 + a**2 - lever**2)
    assert np.hypot(*(trailer_axle(vehicle, x) - centre)) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("declare", [articulated, articulated_trailer])
def test_the_sign_of_the_actuator_is_the_machines_business(
    declare: Callable[..., Model], evaluate: Any, draw: Any
) -> None:
    straight, reverse = (declare(VehicleParameters(joint_sign=sign)) for sign in (1, -1))
    point = draw(straight, np.random.default_rng(7))
    for name in ("derivative", "output"):
        expected = evaluate(straight, getattr(straight, name), *point)
        np.testing.assert_array_equal(evaluate(reverse, getattr(reverse, name), *point), expected)
