import math
from dataclasses import replace

import numpy as np
import pytest
from estimators import MovingHorizonEstimator

from drawbar.estimation.articulated import ArticulatedEstimation
from drawbar.estimation.settings import ArticulatedEstimatorSettings, ScreeningSettings, TricycleEstimatorSettings
from drawbar.estimation.tricycle import TricycleEstimation
from drawbar.geometry import wrap
from drawbar.signals import FixStatus, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

MASKED = dict.fromkeys(("tractor_x", "tractor_y", "trailer_x", "trailer_y"), math.nan)
SLIPS = ("longitudinal_slip", "tractor_slip", "trailer_slip")
ANGLES = ("hitch_angle", "tractor_steering", "trailer_steering", "steering_offset", "tractor_crab", "trailer_crab")


def drive(model, travel, *, straight=False):
    """Return states and outputs of 50 s at constant slip, with the steering at work or not at all."""
    count = 250
    time = 0.2 * np.arange(count)
    if model.problem.model.name == "articulated":
        start = np.array([5.0, -3.0, 2.8, 2.7, 0.1, 0.05])
        p = np.array([0.92, 0.95, 0.01, 0.015, 1.0, -0.01])
        inputs = np.stack([0.05 * np.cos(0.3 * time), 0.02 * np.cos(0.4 * time)], axis=1)
    else:
        start = np.array([5.0, -3.0, 2.8, 7.0, -3.7, 2.7])
        p = np.array([0.92, 0.95, 0.9, 0.1, 1.0])
        inputs = np.stack([0.15 + 0.1 * np.sin(0.3 * time), 0.1 * np.sin(0.4 * time)], axis=1)
    return (*travel(model, start, p, 0.0 * inputs if straight else inputs), p)


def assert_same_slips(left, right, sign=1.0, tolerance=1e-9):
    for name in SLIPS:
        assert getattr(left, name) == pytest.approx(getattr(right, name), abs=tolerance)
    for name in ANGLES:
        assert getattr(left, name) == pytest.approx(sign * getattr(right, name), abs=tolerance)


def test_exact_measurements_of_the_model_are_explained_exactly(model, travel, measure, follow):
    states, outputs, p = drive(model, travel)
    last = follow(model, measure(outputs))[-1]
    names = [variable.name for variable in model.problem.model.states]
    truth = dict(zip(names, states[-1].tolist(), strict=True))
    assert last.status is SolverStatus.SOLVED
    # the articulated model takes steering rates for noise around zero, which leaves a trace; the tricycle's are free
    tolerance = 5e-6 if model.problem.model.name == "articulated" else 2e-6
    assert (last.tractor.x, last.tractor.y) == pytest.approx((truth["tractor_x"], truth["tractor_y"]), abs=tolerance)
    assert (last.trailer.x, last.trailer.y) == pytest.approx(tuple(outputs[-1, 2:4]), abs=tolerance)
    assert wrap(last.tractor.yaw - truth["tractor_yaw"]) == pytest.approx(0.0, abs=tolerance)
    assert wrap(last.trailer.yaw - truth["trailer_yaw"]) == pytest.approx(0.0, abs=tolerance)
    assert last.longitudinal_slip == pytest.approx(p[0], abs=1e-6)
    assert last.tractor_slip == pytest.approx(p[1], abs=10.0 * tolerance)


@pytest.mark.parametrize("angle", [0.7, math.pi / 2, 3.0, -2.2])
def test_the_world_may_turn_and_shift(free_model, recording, follow, rotate, angle):
    shift = (120.0, -75.0)
    estimates = follow(free_model, recording)
    moved = follow(free_model, [rotate(measurement, angle, shift) for measurement in recording])
    c, s = math.cos(angle), math.sin(angle)
    for one, other in zip(estimates, moved, strict=True):
        assert_same_slips(one, other)
        assert other.status is one.status
        for pose, turned in ((one.tractor, other.tractor), (one.trailer, other.trailer)):
            assert turned.x == pytest.approx(c * pose.x - s * pose.y + shift[0], abs=1e-9)
            assert turned.y == pytest.approx(s * pose.x + c * pose.y + shift[1], abs=1e-9)
            assert wrap(turned.yaw - pose.yaw - angle) == pytest.approx(0.0, abs=1e-9)


def test_the_world_may_be_mirrored(free_model, recording, follow, mirror):
    estimates = follow(free_model, recording)
    for one, other in zip(estimates, follow(free_model, map(mirror, recording)), strict=True):
        assert_same_slips(one, other, sign=-1.0)
        for pose, turned in ((one.tractor, other.tractor), (one.trailer, other.trailer)):
            assert (turned.x, turned.y) == pytest.approx((pose.x, -pose.y), abs=1e-9)
            assert wrap(turned.yaw + pose.yaw) == pytest.approx(0.0, abs=1e-9)


def test_yaw_is_continuous_across_half_a_turn(model, recording, follow, rotate):
    # the recording turns by more than 180°, so one of these crosses ±180° wherever it starts
    for angle in (0.0, 2.0, 4.0):
        yaws = [estimate.tractor.yaw for estimate in follow(model, [rotate(m, angle) for m in recording])]
        assert np.abs(np.diff(yaws)).max() < 0.5
        assert np.ptp(yaws) > math.pi


def test_positions_lost_for_ten_seconds_do_not_lose_the_vehicle(model, recording, follow):
    lost = range(150, 200)
    masked = [replace(m, **MASKED) if k in lost else m for k, m in enumerate(recording)]
    known, blind = follow(model, recording), follow(model, masked)
    away = [math.hypot(a.tractor.x - b.tractor.x, a.tractor.y - b.tractor.y) for a, b in zip(known, blind, strict=True)]
    assert max(away[:150]) == 0.0
    assert 0.0 < max(away[150:200]) < 0.5
    assert max(away[230:]) < 0.01


def test_a_sample_that_is_missing_altogether_is_predicted(model, travel, measure, follow):
    _, outputs, _ = drive(model, travel)
    measurements = measure(outputs)
    nothing = dict.fromkeys((*MASKED, "hitch_angle", "speed", "tractor_steering", "trailer_steering"), math.nan)
    blind = follow(model, [*measurements[:-1], replace(measurements[-1], **nothing)])[-1]
    assert blind.status is SolverStatus.SOLVED
    assert (blind.tractor.x, blind.tractor.y) == pytest.approx(tuple(outputs[-1, :2]), abs=0.01)
    assert (blind.trailer.x, blind.trailer.y) == pytest.approx(tuple(outputs[-1, 2:4]), abs=0.01)


def test_a_failing_solver_leaves_the_prediction_and_says_so(model, recording, follow):
    false = [
        replace(measurement, speed=1e308) for measurement in recording[60:62]
    ]  # finite, but not once it is weighed
    *_, masked, failed = follow(model, [*recording[:60], *false])
    assert masked.status is SolverStatus.SOLVED
    assert failed.status is not SolverStatus.SOLVED
    step = math.hypot(failed.tractor.x - masked.tractor.x, failed.tractor.y - masked.tractor.y)
    speed = masked.longitudinal_slip * masked.speed
    assert step == pytest.approx(0.2 * speed, rel=0.01)


def test_an_infinite_reading_is_a_missing_one(model, recording, follow):
    infinite, missing = list(recording[:80]), list(recording[:80])
    infinite[60] = replace(recording[60], tractor_x=math.inf, trailer_y=-math.inf, speed=math.inf)
    missing[60] = replace(recording[60], tractor_x=math.nan, trailer_y=math.nan, speed=math.nan)
    assert follow(model, infinite) == follow(model, missing)


def screening_model(**changes):
    settings = ArticulatedEstimatorSettings(model="articulated", **changes)
    return ArticulatedEstimation(VehicleParameters(), SensorNoise(), settings, 0.2)


def test_a_wrong_first_yaw_is_overruled_and_the_window_begins_anew(recording):
    estimator = MovingHorizonEstimator(screening_model(first_yaw_error=math.pi / 4), recording[0])
    truth = MovingHorizonEstimator(screening_model(), recording[0])
    rows, rejected, errors = [], [], []
    for measurement in recording[:30]:
        estimate, right = estimator.update(measurement), truth.update(measurement)
        rows.append(estimator.solver.newest)
        rejected.append(estimate.trailer_fix is FixStatus.REJECTED)
        errors.append(abs(estimate.tractor.yaw - right.tractor.yaw))
        assert estimate.status is SolverStatus.SOLVED
        estimator.prepare()
        truth.prepare()
    window = estimator.solver.problem.horizon
    assert rows == [0, *range(window + 1), *[window] * (28 - window)]  # the second contradiction overrules
    assert rejected == [True] + [False] * 29
    assert errors[0] > 0.5
    assert max(errors[1:]) < 0.1


@pytest.mark.parametrize(("name", "rows"), [("articulated", [2, 3]), ("tricycle", [2, 5])])
def test_a_new_base_station_is_believed_on_the_present_branch(recording, name, rows):
    model = screening_model()
    if name == "tricycle":
        settings = TricycleEstimatorSettings(model="tricycle", weighting="statistical", screening=ScreeningSettings())
        model = TricycleEstimation(VehicleParameters(), SensorNoise(), settings, 0.2)
    estimator = MovingHorizonEstimator(model, recording[0])
    solver = estimator.solver
    for measurement in recording[:60]:
        estimator.update(measurement)
        estimator.prepare()
    solver.x[:, rows] += 4.0 * math.pi  # continuous along a run, so whole turns add up
    solver.workspace.array("prior")[rows] += 4.0 * math.pi
    yaws, begun = [], []
    for measurement in recording[60:90]:
        towed = replace(measurement, tractor_x=measurement.tractor_x + 4.0, trailer_x=measurement.trailer_x + 4.0)
        estimate = estimator.update(towed)
        yaws.append((estimate.tractor.yaw, estimate.trailer.yaw))
        begun.append(solver.newest == 0)
        estimator.prepare()
    assert begun.index(True) == 5
    assert begun.count(True) == 1
    assert np.abs(np.diff(yaws, axis=0)).max() < 0.3
    assert np.min(yaws) > 8.0
    assert (estimate.tractor.x, estimate.tractor.y) == pytest.approx((towed.tractor_x, towed.tractor_y), abs=0.3)


def test_what_an_exposed_antenna_reported_just_before_is_forgotten(recording):
    estimator = MovingHorizonEstimator(screening_model(), recording[0])
    memory, newest = ScreeningSettings().memory, estimator.solver.problem.horizon
    for k, m in enumerate(recording[:200]):
        jumped = replace(m, trailer_y=m.trailer_y + 0.15) if k >= 150 else m
        before = estimator.solver.y[:, :4].copy()
        estimate = estimator.update(jumped)
        if k >= 150 and estimate.trailer_fix is FixStatus.REJECTED:
            break
        estimator.prepare()
    else:
        pytest.fail("the trailer's antenna was not suspected")
    after = estimator.solver.y[:, :4]
    assert np.isnan(after[newest - memory :, 2:]).all()
    np.testing.assert_array_equal(after[: newest - memory], before[: newest - memory])
    np.testing.assert_array_equal(after[:newest, :2], before[:newest, :2])
    assert np.isfinite(before[newest - memory : newest, 2:]).any()


def test_a_failing_preparation_shows_in_the_next_status(recording):
    estimator = MovingHorizonEstimator(screening_model(), recording[0])
    for measurement in recording[:30]:
        assert estimator.update(measurement).status is SolverStatus.SOLVED
        estimator.prepare()
    process = estimator.solver.workspace.array("process")
    process[0], usual = 1e200, process[0]  # its square is no number any more: the oldest stage cannot be absorbed
    estimator.update(recording[30])
    estimator.prepare()
    process[0] = usual
    assert estimator.update(recording[31]).status is SolverStatus.NOT_FINITE
    estimator.prepare()
    assert estimator.update(recording[32]).status is SolverStatus.SOLVED
