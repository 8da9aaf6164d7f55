import math

import numpy as np
import pytest

from drawbar.errors import HardwareError
from drawbar.estimation.description import known, measured, yaws_at_rest
from drawbar.geometry import wrap
from drawbar.signals import Measurement
from drawbar.vehicle.parameters import VehicleParameters

NAMES = ("tractor_x", "tractor_y", "trailer_x", "trailer_y", "hitch_angle", "speed")
NAMES = (*NAMES, "tractor_steering", "trailer_steering")


def standing(vehicle, rng):
    """Return true yaws and the exact measurement of a vehicle at rest anywhere, the two joints at any angle."""
    theta, beta, joint = rng.uniform(-math.pi, math.pi), *rng.uniform(-1.2, 1.2, size=2)
    phi = theta - beta
    psi = phi - joint
    x, y = rng.uniform(-1e4, 1e4, size=2)

    def ahead(angle):
        return np.array([math.cos(angle), math.sin(angle)])

    free_joint = np.array([x, y]) - vehicle.free_joint_offset * ahead(theta)
    axle = free_joint - vehicle.drawbar_length * ahead(phi) - vehicle.trailer_length * ahead(psi)
    antenna = axle + vehicle.trailer_antenna * ahead(psi)
    values = (x, y, *antenna.tolist(), beta, 0.0, 0.1, joint)
    return theta, psi, Measurement(time=0.0, **dict(zip(NAMES, values, strict=True)))


@pytest.mark.parametrize(
    "vehicle",
    [VehicleParameters(), VehicleParameters(wheelbase=2.8, hitch_length=2.0, drawbar_length=1.1, trailer_antenna=0.0)],
    ids=["paper", "larger"],
)
def test_both_yaws_are_known_exactly_at_rest(vehicle):
    rng = np.random.default_rng(11)
    for _ in range(500):
        theta, psi, measurement = standing(vehicle, rng)
        tractor, trailer = yaws_at_rest(vehicle, measurement)
        assert wrap(tractor - theta) == pytest.approx(0.0, abs=1e-10)
        assert wrap(trailer - psi) == pytest.approx(0.0, abs=1e-10)


def test_first_guess_is_the_state_at_rest(model, measure):
    rng = np.random.default_rng(12)
    for _ in range(50):
        theta, psi, measurement = standing(VehicleParameters(), rng)
        guess = model.first_guess(measurement)
        names = [variable.name for variable in (*model.problem.model.states, *model.problem.model.parameters)]
        state = dict(zip(names, guess.tolist(), strict=True))
        assert wrap(state["tractor_yaw"] - theta) == pytest.approx(0.0, abs=1e-10)
        assert wrap(state["trailer_yaw"] - psi) == pytest.approx(0.0, abs=1e-10)
        assert (state["tractor_x"], state["tractor_y"]) == (measurement.tractor_x, measurement.tractor_y)
        estimate = model.estimate(guess.tolist(), measurement, 0)
        assert (estimate.trailer.x, estimate.trailer.y) == pytest.approx((measurement.trailer_x, measurement.trailer_y))
        assert estimate.hitch_angle == pytest.approx(measurement.hitch_angle)
        assert estimate.trailer_steering == pytest.approx(measurement.trailer_steering)


@pytest.mark.parametrize("missing", [math.nan, math.inf, -math.inf])
def test_first_guess_needs_positions_and_nothing_else(model, missing):
    _, _, measurement = standing(VehicleParameters(), np.random.default_rng(13))
    values = {name: getattr(measurement, name) for name in NAMES}
    for name in NAMES[:4]:
        with pytest.raises(HardwareError, match="lacks a position"):
            model.first_guess(Measurement(time=0.0, **(values | {name: missing})))
    for name in NAMES[4:]:
        assert np.isfinite(model.first_guess(Measurement(time=0.0, **(values | {name: missing})))).all()


def test_what_is_not_finite_is_missing():
    values = dict(zip(NAMES, (1.0, math.inf, math.nan, -2.0, -math.inf, 0.0, 0.5, 0.25), strict=True))
    expected = (1.0, math.nan, math.nan, -2.0, math.nan, 0.0, 0.5, 0.25)
    assert measured(Measurement(time=0.0, **values)) == pytest.approx(expected, nan_ok=True, abs=0.0)
    assert [known(value) for value in (1.5, math.nan, math.inf, -math.inf)] == [1.5, 0.0, 0.0, 0.0]
