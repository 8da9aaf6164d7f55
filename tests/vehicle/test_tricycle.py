"""The paper's model against the chain (docs/theory/vehicle-models.md)."""

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle

VEHICLE = VehicleParameters()


def steady_articulation(evaluate: Any, steering: float, joint: float) -> float:
    """Return theta - psi at which the chain turns as one body at 1 m/s without slip."""
    model, p = articulated(VEHICLE), np.array([1.0, 1.0, 0.0, 0.0, 1.0, 0.0])

    def difference(gamma: float) -> float:
        x = np.array([0.0, 0.0, 0.0, -gamma, steering, joint])
        rates = evaluate(model, model.derivative, x, np.zeros(2), p)
        return float(rates[2] - rates[3])

    return float(brentq(difference, -1.2, 1.2, xtol=1e-14))


@pytest.mark.parametrize("radius", [6.67, 8.0, 10.0, -8.0, 100.0])
@pytest.mark.parametrize("joint", [-0.2, 0.0, 0.2])
def test_agrees_with_the_chain_in_steady_turning(radius: float, joint: float, evaluate: Any) -> None:
    steering = np.arctan(VEHICLE.wheelbase / radius)
    gamma = steady_articulation(evaluate, steering, joint)
    model = tricycle(VEHICLE)
    x, u = np.array([0.0, 0.0, 0.0, -2.2, 0.0, -gamma]), np.array([steering, joint])
    rates = evaluate(model, model.derivative, x, u, np.array([1.0, 1.0, 1.0, gamma - joint, 1.0]))
    turn = 1.0 / radius
    assert rates[2] == pytest.approx(turn, rel=1e-12)
    # The paper takes tractor and drawbar for one rigid beam: the lever d counts at gamma instead of J.
    beam = turn * VEHICLE.drawbar_length * (np.cos(joint) - np.cos(gamma)) / VEHICLE.trailer_length
    assert rates[5] - turn == pytest.approx(beam, abs=1e-12)
    assert abs(beam) <= 0.02 * abs(turn)


def test_predicts_that_the_joint_turns_the_trailer_left_as_the_chain_does_not(evaluate: Any) -> None:
    paper, chain = tricycle(VEHICLE), articulated(VEHICLE)
    joint = 0.1
    yaw_rate = evaluate(paper, paper.derivative, np.zeros(6), np.array([0, joint]), np.array([1, 1, 1, 0, 1]))[5]
    assert yaw_rate == pytest.approx(np.sin(joint) / VEHICLE.trailer_length)
    x, p = np.array([0, 0, 0, 0, 0, joint]), np.array([1, 1, 0, 0, 1, 0])
    assert evaluate(chain, chain.derivative, x, np.zeros(2), p)[3] == pytest.approx(0.0, abs=1e-15)
    assert evaluate(chain, chain.derivative, x, np.array([0.0, 0.1]), p)[3] < 0.0


def test_slip_factors_scale_speed_and_steering(evaluate: Any, draw: Any) -> None:
    model = tricycle(VEHICLE)
    x, u, p = draw(model, np.random.default_rng(8))
    mu, kappa, eta, beta, v = p
    ideal = evaluate(model, model.derivative, x, u * [kappa, eta], np.array([1.0, 1.0, 1.0, beta, mu * v]))
    np.testing.assert_allclose(evaluate(model, model.derivative, x, u, p), ideal, atol=1e-14)
