"""What the last command says of the steering until the next sample."""

import math
from dataclasses import replace

import numpy as np
import pytest
from estimators import ExtendedKalmanFilter, MovingHorizonEstimator
from ordinary import measured

from drawbar.estimation.articulated import ArticulatedEstimation
from drawbar.estimation.settings import ArticulatedEstimatorSettings
from drawbar.signals import Command
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

LAG, LIMIT, SAMPLE_TIME = 0.3, 0.4, 0.2


def estimation(**vehicle):
    settings = ArticulatedEstimatorSettings(model="articulated")
    return ArticulatedEstimation(VehicleParameters(**vehicle), SensorNoise(), settings, SAMPLE_TIME)


REST = measured(2.15, 0.0, 0.0, 0.0, hitch_angle=math.nan)


def command(tractor, trailer):
    return Command(time=0.0, tractor_steering=tractor, trailer_steering=trailer, speed=1.0)


@pytest.mark.parametrize("error", [0.0, 0.02, 0.119, 0.121, 0.15, 0.3, -0.02, -0.15, -1.0])
def test_mean_rate_is_that_of_the_integrated_actuator(compiled, error):
    model = compiled(estimation(steering_lag=LAG, tractor_steering_rate=LIMIT))
    steps, left = 200_000, error
    for _ in range(steps):
        left -= min(max(left / LAG, -LIMIT), LIMIT) * SAMPLE_TIME / steps
    model.state[4] = 0.1
    rate = model.steering_rates(command(0.1 + error, 0.0))[0]
    assert rate == pytest.approx((error - left) / SAMPLE_TIME, abs=1e-5)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_reversed_joint_goes_the_other_way(compiled, sign):
    tractor, trailer = compiled(estimation(joint_sign=sign)).steering_rates(command(0.05, 0.05))
    assert tractor == pytest.approx(0.05 * -math.expm1(-SAMPLE_TIME / LAG) / SAMPLE_TIME)
    assert trailer == pytest.approx(sign * tractor)


@pytest.mark.parametrize("kind", [MovingHorizonEstimator, ExtendedKalmanFilter])
def test_steering_behind_a_coarse_sensor_is_known_better_with_its_command(compiled, kind):
    """The vehicle stands; both angles follow a sine behind their lag and are measured in steps of 2°."""
    step, errors, actuator = math.radians(2.0), {True: [], False: []}, compiled(estimation())
    for told, into in errors.items():
        estimator, angle = kind(estimation(), REST), 0.0
        for k in range(150):
            asked = 0.1 * math.sin(0.15 * k)
            rounded = step * round(angle / step)
            seen = replace(REST, time=SAMPLE_TIME * k, tractor_steering=rounded)
            into.append(estimator.update(seen).tractor_steering - angle)
            estimator.prepare(command(asked, 0.0) if told else None)
            actuator.state[4] = angle
            angle += SAMPLE_TIME * actuator.steering_rates(command(asked, 0.0))[0]
    with_command, without = (np.sqrt(np.mean(np.square(errors[told][20:]))) for told in (True, False))
    assert with_command < 0.5 * without
    assert with_command < math.radians(0.3)


@pytest.mark.parametrize("left_out", [False, True])
@pytest.mark.parametrize("samples", [3, 40], ids=["filling", "full"])
@pytest.mark.parametrize("kind", [MovingHorizonEstimator, ExtendedKalmanFilter])
def test_what_is_expected_next_has_followed_the_newest_command(compiled, kind, samples, left_out):
    """And not the steering's motion of the sample before, which is what the window repeats."""
    estimator, actuator = kind(estimation(), REST), compiled(estimation())
    for k in range(samples):
        estimator.update(replace(REST, time=SAMPLE_TIME * k))
        estimator.prepare(command(0.0, 0.0))
    now = estimator.update(replace(REST, time=SAMPLE_TIME * samples))
    if left_out:
        estimator.prepare(command(0.0, 0.0))
        now = estimator.expected()
    acts = estimator.skip if left_out else estimator.prepare
    acts(command(0.1, -0.06))
    tractor, trailer = actuator.steering_rates(command(0.1, -0.06))
    then = estimator.expected()
    assert then.tractor_steering - now.tractor_steering == pytest.approx(SAMPLE_TIME * tractor, rel=1e-6)
    assert then.trailer_steering - now.trailer_steering == pytest.approx(SAMPLE_TIME * trailer, rel=1e-6)
