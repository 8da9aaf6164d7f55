import math
from dataclasses import replace

import numpy as np
import pytest
from estimators import ExtendedKalmanFilter, MovingHorizonEstimator

from drawbar.estimation.articulated import ArticulatedEstimation
from drawbar.estimation.settings import ArticulatedDrift, ArticulatedEstimatorSettings, TricycleEstimatorSettings
from drawbar.estimation.tricycle import TricycleEstimation
from drawbar.geometry import wrap
from drawbar.signals import Measurement, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

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
def test_both_yaws_are_known_exactly_at_rest(compiled, vehicle):
    settings, rng = ArticulatedEstimatorSettings(model="articulated"), np.random.default_rng(11)
    model = compiled(ArticulatedEstimation(vehicle, SensorNoise(), settings, 0.2))
    for _ in range(500):
        theta, psi, measurement = standing(vehicle, rng)
        tractor, trailer = model.first_guess(measurement)[2:4]
        assert wrap(tractor - theta) == pytest.approx(0.0, abs=1e-10)
        assert wrap(trailer - psi) == pytest.approx(0.0, abs=1e-10)


def test_first_guess_is_the_state_at_rest(compiled, model):
    rng, header = np.random.default_rng(12), compiled(model)
    names = [variable.name for variable in (*model.problem.model.states, *model.problem.model.parameters)]
    for _ in range(50):
        theta, psi, measurement = standing(VehicleParameters(), rng)
        state = dict(zip(names, header.first_guess(measurement).tolist(), strict=False))
        assert wrap(state["tractor_yaw"] - theta) == pytest.approx(0.0, abs=1e-10)
        assert wrap(state["trailer_yaw"] - psi) == pytest.approx(0.0, abs=1e-10)
        assert (state["tractor_x"], state["tractor_y"]) == (measurement.tractor_x, measurement.tractor_y)
        estimate = header.estimate(measurement)
        assert (estimate.trailer.x, estimate.trailer.y) == pytest.approx((measurement.trailer_x, measurement.trailer_y))
        assert estimate.hitch_angle == pytest.approx(measurement.hitch_angle)
        assert estimate.trailer_steering == pytest.approx(measurement.trailer_steering)


@pytest.mark.parametrize("missing", [math.nan, math.inf, -math.inf])
def test_first_guess_needs_positions_and_nothing_else(compiled, model, missing):
    _, _, measurement = standing(VehicleParameters(), np.random.default_rng(13))
    header, values = compiled(model), {name: getattr(measurement, name) for name in NAMES}
    for name in NAMES[:4]:
        assert header.first_guess(Measurement(time=0.0, **(values | {name: missing}))) is None
    for name in NAMES[4:]:
        assert np.isfinite(header.first_guess(Measurement(time=0.0, **(values | {name: missing})))).all()


@pytest.mark.parametrize("kind", [MovingHorizonEstimator, ExtendedKalmanFilter])
def test_no_estimator_begins_without_a_position(model, kind):
    _, _, measurement = standing(VehicleParameters(), np.random.default_rng(14))
    assert kind(model, replace(measurement, trailer_y=math.nan)).begun is SolverStatus.BAD_INPUT
    assert kind(model, measurement).begun is SolverStatus.SOLVED


def test_what_is_not_finite_is_missing(compiled, model):
    values = dict(zip(NAMES, (1.0, math.inf, math.nan, -2.0, -math.inf, 0.0, 0.5, 0.25), strict=True))
    expected = (1.0, math.nan, math.nan, -2.0, math.nan, 0.0, 0.5, 0.25)
    outputs = compiled(model).outputs(Measurement(time=0.0, **values))
    assert outputs[:8] == pytest.approx(expected, nan_ok=True, abs=0.0)


def test_crab_angles_are_believed_small_only_while_a_fix_is_missing(compiled):
    settings = ArticulatedEstimatorSettings(model="articulated")
    model = compiled(ArticulatedEstimation(VehicleParameters(), SensorNoise(), settings, 0.2))
    _, _, measurement = standing(VehicleParameters(), np.random.default_rng(15))
    assert model.outputs(measurement)[10:] == pytest.approx((math.nan, math.nan, 0.0, 0.0), nan_ok=True, abs=0.0)
    for name in NAMES[:4]:
        missing = replace(measurement, **{name: math.nan})
        assert model.outputs(missing)[10:] == pytest.approx((0.0,) * 4, abs=0.0)


@pytest.mark.parametrize(("told", "output"), [(0.12, 0.12), (math.nan, math.nan), (math.inf, math.nan)])
@pytest.mark.parametrize("name", ["tractor_yaw", "tractor_yaw_rate"])
def test_yaw_and_yaw_rate_are_outputs_where_they_are_measured(compiled, name, told, output):
    settings = ArticulatedEstimatorSettings(model="articulated")
    model = compiled(ArticulatedEstimation(VehicleParameters(), SensorNoise(), settings, 0.2))
    _, _, measurement = standing(VehicleParameters(), np.random.default_rng(17))
    there = model.outputs(replace(measurement, **{name: told}))
    assert there[{"tractor_yaw": 8, "tractor_yaw_rate": 9}[name]] == pytest.approx(output, nan_ok=True, abs=0.0)


def test_steering_that_is_not_measured_stays_as_it_was_on_the_papers_model(compiled):
    settings = TricycleEstimatorSettings(model="tricycle")
    tricycle = compiled(TricycleEstimation(VehicleParameters(), SensorNoise(), settings, 0.2))
    _, _, measurement = standing(VehicleParameters(), np.random.default_rng(16))
    blind = replace(measurement, tractor_steering=math.nan, trailer_steering=math.inf)
    assert tricycle.estimate(blind).tractor_steering == tricycle.estimate(blind).trailer_steering == 0.0
    tricycle.estimate(measurement)
    estimate = tricycle.estimate(blind)
    assert estimate.tractor_steering == measurement.tractor_steering
    assert estimate.trailer_steering == measurement.trailer_steering


def test_a_slope_moves_both_crab_angles_and_the_offset_alike_and_nothing_else():
    settings = ArticulatedEstimatorSettings(model="articulated", drift=ArticulatedDrift(slope=0.007))
    problem = ArticulatedEstimation(VehicleParameters(), SensorNoise(), settings, 0.2).problem
    assert problem.common_deviation == dict.fromkeys(("steering_offset", "trailer_crab", "tractor_crab"), 0.007)


@pytest.mark.parametrize("sample_time", [0.05, 0.1, 0.5])
def test_process_noise_grows_with_time_not_with_samples(sample_time):
    settings = ArticulatedEstimatorSettings(model="articulated")

    def variances(step):
        problem = ArticulatedEstimation(VehicleParameters(), SensorNoise(), settings, step).problem
        return [
            np.array(list(each.values())) ** 2 / step for each in (problem.process_deviation, problem.common_deviation)
        ]

    for mine, at_5_hertz in zip(variances(sample_time), variances(0.2), strict=True):
        np.testing.assert_allclose(mine, at_5_hertz, rtol=1e-12)
