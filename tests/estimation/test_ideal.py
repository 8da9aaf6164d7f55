import math

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.errors import HardwareError
from drawbar.estimation.ideal import IdealEstimator
from drawbar.signals import Command
from drawbar.step.build import build_machine, build_path


def test_everything_is_true():
    configuration = load_configuration("articulated-ideal", ["machine.ground.steering_offset=0.01"])
    path, _ = build_path(configuration)
    machine = build_machine(configuration, path, seed=3)
    estimator = IdealEstimator(machine.truth)
    for k in range(50):
        machine.write(Command(time=0.2 * k, tractor_steering=0.2, trailer_steering=-0.1, speed=1.0))
    truth, measurement = machine.truth(), machine.read()
    estimate = estimator.update(measurement)
    assert estimate.time == truth.time == measurement.time
    same = set(type(truth).__dataclass_fields__) & set(type(estimate).__dataclass_fields__)
    assert all(getattr(estimate, name) == getattr(truth, name) for name in same)
    assert set(type(estimate).__dataclass_fields__) - same >= {"hitch_angle", "trailer_slip", "status"}
    assert estimate.trailer_slip == 1.0
    # the sensor, whose noise is 1°, sees the very angle
    assert estimate.hitch_angle == pytest.approx(measurement.hitch_angle, abs=0.07)
    assert abs(estimate.hitch_angle) > 0.1
    estimator.prepare()
    assert math.isnan(estimator.times.feedback)
    assert math.isnan(estimator.times.prepare)


def test_a_machine_without_truth_is_refused():
    with pytest.raises(HardwareError, match="only a simulated machine knows"):
        IdealEstimator(lambda: None)


def test_errors_that_are_asked_for_are_added_across_and_around():
    configuration = load_configuration("articulated-ideal")
    machine = build_machine(configuration, build_path(configuration)[0], seed=3)
    for k in range(50):
        machine.write(Command(time=0.2 * k, tractor_steering=0.2, trailer_steering=-0.1, speed=1.0))
    truth = machine.truth()
    errors = np.array([0.1, 0.02, 0.03, -0.2, -0.01, 0.04])
    estimate = IdealEstimator(lambda: truth, lambda: errors).update(machine.read())
    for body, (left, turn, steering) in zip(("tractor", "trailer"), errors.reshape(2, 3), strict=True):
        believed, true = getattr(estimate, body), getattr(truth, body)
        shift = np.array([believed.x - true.x, believed.y - true.y])
        assert shift @ [math.cos(true.yaw), math.sin(true.yaw)] == pytest.approx(0.0, abs=1e-12)
        assert shift @ [-math.sin(true.yaw), math.cos(true.yaw)] == pytest.approx(left, abs=1e-12)
        assert believed.yaw - true.yaw == pytest.approx(turn, abs=1e-12)
        assert getattr(estimate, f"{body}_steering") - getattr(truth, f"{body}_steering") == pytest.approx(steering)
    assert estimate.hitch_angle == pytest.approx(
        estimate.tractor.yaw - estimate.trailer.yaw - estimate.trailer_steering, abs=1e-12
    )
    assert estimate.tractor_crab == truth.tractor_crab
