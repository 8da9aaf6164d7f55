"""Each subsystem, told its coupling, is the whole model's rows."""

from typing import Any

import numpy as np

from drawbar.vehicle.articulated import (
    articulated,
    articulated_tracking,
    articulated_tractor,
    articulated_trailer,
)
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle, tricycle_tractor, tricycle_trailer

VEHICLE = VehicleParameters()


def test_tricycle_splits_into_tractor_and_trailer(evaluate: Any, draw: Any) -> None:
    whole, rng = tricycle(VEHICLE), np.random.default_rng(9)
    tractor, trailer = tricycle_tractor(VEHICLE), tricycle_trailer(VEHICLE)
    for _ in range(20):
        x, u, p = draw(whole, rng)
        mu, kappa, eta, beta, v = p
        coupling = VEHICLE.hitch_length / VEHICLE.wheelbase * np.tan(kappa * u[0])
        rates = evaluate(whole, whole.derivative, x, u, p)
        front = evaluate(tractor, tractor.derivative, x[:3], u[:1], np.array([mu, kappa, v]))
        back = evaluate(trailer, trailer.derivative, x[3:], u[1:], np.array([mu, eta, beta, v, coupling]))
        np.testing.assert_allclose(np.concatenate([front, back]), rates, atol=1e-14)


def test_tricycle_outputs_are_position_and_steering(evaluate: Any, draw: Any) -> None:
    for declare in (tricycle_tractor, tricycle_trailer):
        model = declare(VEHICLE)
        x, u, p = draw(model, np.random.default_rng(10))
        np.testing.assert_array_equal(evaluate(model, model.output, x, u, p), [x[0], x[1], u[0]])


def test_articulated_splits_into_tractor_and_trailer(evaluate: Any, draw: Any) -> None:
    whole, rng = articulated(VEHICLE), np.random.default_rng(11)
    tractor, trailer = articulated_tractor(VEHICLE), articulated_trailer(VEHICLE)
    for _ in range(20):
        x, u, p = draw(whole, rng)
        mu, kappa, offset, trailer_crab, v, crab = p
        reference = rng.uniform(-3, 3, 3)
        rates = evaluate(whole, whole.derivative, x, u, p)
        known = np.array([mu, kappa, offset, crab, v, *reference])
        front = evaluate(tractor, tractor.derivative, x[[0, 1, 2, 4]], u[:1], known)
        np.testing.assert_allclose(front, rates[[0, 1, 2, 4]], atol=1e-13)
        known = np.array([mu, crab, trailer_crab, v, rates[2], *x[:3], *reference])
        own = np.array([x[2] - x[3], x[5]])
        back = evaluate(trailer, trailer.derivative, own, u[1:], known)
        np.testing.assert_allclose(back, [rates[2] - rates[3], rates[5]], atol=1e-13)


def test_articulated_outputs_are_signed_errors_from_the_reference(evaluate: Any, draw: Any) -> None:
    whole, tractor, trailer = (f(VEHICLE) for f in (articulated, articulated_tractor, articulated_trailer))
    rng = np.random.default_rng(12)
    x, u, p = draw(whole, rng)
    antenna = evaluate(whole, whole.output, x, u, p)[2:4]
    yaw, offset, crab = 0.7, 0.4, 0.05
    left = np.array([-np.sin(yaw), np.cos(yaw)])
    reference = (*(x[:2] - offset * left), yaw)
    state = np.array([*x[:3], x[4]])
    known = np.array([0.9, 1.0, 0.0, crab, 1.0, *reference])
    errors = evaluate(tractor, tractor.output, state, np.array([0.3]), known)
    np.testing.assert_allclose(errors, [offset, x[2] + crab - yaw, x[4], 0.3], atol=1e-12)
    known = np.array([0.9, crab, 0.0, 1.0, 0.1, *x[:3], *(antenna - offset * left), yaw])
    errors = evaluate(trailer, trailer.output, np.array([x[2] - x[3], x[5]]), np.array([0.3]), known)
    np.testing.assert_allclose(errors, [offset, x[5], 0.3], atol=1e-12)


def test_what_the_centralised_controller_weighs_is_what_both_subsystems_weigh(evaluate: Any, draw: Any) -> None:
    whole, chain = articulated_tracking(VEHICLE), articulated(VEHICLE)
    tractor, trailer = articulated_tractor(VEHICLE), articulated_trailer(VEHICLE)
    rng = np.random.default_rng(13)
    for _ in range(20):
        x, u, p = draw(whole, rng)
        mu, kappa, offset, trailer_crab, v, crab = p[:6]
        rates = evaluate(chain, chain.derivative, x, u, p[:6])
        np.testing.assert_array_equal(evaluate(whole, whole.derivative, x, u, p), rates)
        known = np.array([mu, kappa, offset, crab, v, *p[6:9]])
        front = evaluate(tractor, tractor.output, x[[0, 1, 2, 4]], u[:1], known)
        known = np.array([mu, crab, trailer_crab, v, rates[2], *x[:3], *p[9:]])
        back = evaluate(trailer, trailer.output, np.array([x[2] - x[3], x[5]]), u[1:], known)
        errors = evaluate(whole, whole.output, x, u, p)
        np.testing.assert_allclose(errors, np.concatenate([front, back]), atol=1e-12)
