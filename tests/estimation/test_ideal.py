import math
from dataclasses import replace

import numpy as np
import pytest
from c_signals import given
from estimators import Estimator

from drawbar.config import load_configuration
from drawbar.estimation.ideal import IDEAL_UNIT, TrueState
from drawbar.signals import Command, SolverStatus
from drawbar.simulation import build_machine, build_path

SLIDE = (0.01, -0.03, 0.36)


@pytest.fixture(scope="module")
def drive():
    """Return the truth and the measurement after ten seconds on a curve."""
    configuration = load_configuration("articulated-ideal", ["machine.ground.steering_offset=0.01"])
    machine = build_machine(configuration, build_path(configuration)[0], seed=3)
    for k in range(50):
        machine.write(Command(time=0.2 * k, tractor_steering=0.2, trailer_steering=-0.1, speed=1.0))
        measurement = machine.read()
    return machine.truth(), measurement


def test_the_ideal_estimate_is_the_truth(drive):
    truth, measurement = drive
    estimate = TrueState(0.2).estimate(truth, SLIDE, 0.0)
    same = set(type(truth).__dataclass_fields__) & set(type(estimate).__dataclass_fields__)
    assert all(getattr(estimate, name) == getattr(truth, name) for name in same)
    assert set(type(estimate).__dataclass_fields__) - same >= {"hitch_angle", "trailer_slip", "status"}
    assert estimate.trailer_slip == 1.0
    assert (estimate.slide_east, estimate.slide_north, estimate.creep) == SLIDE
    # the sensor, whose noise is 1°, sees the very angle
    assert estimate.hitch_angle == pytest.approx(measurement.hitch_angle, abs=0.07)
    assert abs(estimate.hitch_angle) > 0.1


def test_the_front_wheels_stand_as_they_did_before_the_body_lag(drive):
    truth, _ = drive
    state = TrueState(0.2)
    told = [
        state.estimate(replace(truth, tractor_steering=angle), SLIDE, lag).tractor_steering
        for angle, lag in ((0.1, 0.0), (0.3, 0.0), (0.2, 0.1), (0.2, 0.5))
    ]
    assert told == pytest.approx([0.1, 0.3, 0.25, 0.2])


def test_errors_that_are_asked_for_are_added_across_and_around(drive):
    truth, _ = drive
    errors = np.array([0.1, 0.02, 0.03, -0.2, -0.01, 0.04])
    estimate = TrueState(0.2, lambda: errors).estimate(truth, SLIDE, 0.0)
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


def test_the_estimator_hands_on_what_it_was_given_at_the_measurements_time(drive):
    truth, measurement = drive
    estimator, estimate = Estimator(IDEAL_UNIT, measurement), TrueState(0.2).estimate(truth, SLIDE, 0.0)
    estimator.live.array("given")[:] = given(estimate)
    assert estimator.begun is SolverStatus.SOLVED
    assert estimator.update(replace(measurement, time=99.0)) == replace(estimate, time=99.0)
    assert estimator.prepare() is estimator.skip() is SolverStatus.SOLVED
