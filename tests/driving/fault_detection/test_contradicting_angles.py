"""Contradicting angles and turning error: a hitch or joint sensor that drifts is seen, and that of the front wheels."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.driving.fault_detection.contradicting_angles import ContradictingAngles
from drawbar.driving.fault_detection.running_rms import RunningRms
from drawbar.driving.fault_detection.turning_error import TurningError
from drawbar.driving.stand_in.rehearsal import Rehearsal
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.messages import SupervisorState
from drawbar.safety.causes import BY_CODE, Cause
from drawbar.simulation import build_path

DEGREE = math.pi / 180.0
USUAL = 30.0
"""time before a fault, s"""


def contradicts_after(difference, *, noise=0.5, sample_time=0.2, until=20.0, seed=3):
    """Return after how long a difference is a contradiction, s; infinity: never.

    difference(t): of measured and simulated angle a time after the fault, degrees; noise: of it before and after.
    """
    angles, rng = ContradictingAngles(sample_time), np.random.default_rng(seed)
    for k in range(round((USUAL + until) / sample_time)):
        time = k * sample_time - USUAL
        angles.update(DEGREE * (rng.normal(0.0, noise) + (difference(time) if time > 0.0 else 0.0)), 0.0)
        if angles.share > 1.0:
            assert time > 0.0
            return time
    return math.inf


@pytest.mark.parametrize("sample_time", [0.05, 0.1, 0.2])
def test_one_that_drifts_is_seen_once_it_is_several_degrees_away(sample_time):
    for sign in (1.0, -1.0):
        time = contradicts_after(lambda t, sign=sign: sign * 2.0 * t, sample_time=sample_time)
        assert 2.5 < time < 3.8
    assert contradicts_after(lambda t: 0.3 * t) > 15.0
    assert contradicts_after(lambda t: 4.0) == math.inf


@pytest.mark.parametrize("sample_time", [0.05, 0.2])
def test_what_is_usual_is_that_of_two_seconds_ago(sample_time):
    usual = RunningRms(sample_time, prior=1.0, prior_time=5.0)
    for count in range(round(2.0 / sample_time)):
        assert usual.value == 1.0, count
        usual.add(2.0)
    assert usual.value > 1.0


def test_on_rough_ground_more_is_usual():
    assert contradicts_after(lambda t: 8.0) < 2.0
    for seed in range(5):
        assert contradicts_after(lambda t: 4.0, noise=5.0, seed=seed) == math.inf
        assert contradicts_after(lambda t: 30.0, noise=5.0, seed=seed) < 2.0


def test_what_is_not_known_contradicts_nothing():
    angles = ContradictingAngles(0.2)
    for known in ((1.0, math.nan), (math.nan, 1.0)):
        for _ in range(20):
            angles.update(*known)
            assert not angles.share
    for count in range(5):
        angles.update(1.0, 0.0)
        assert (angles.share > 1.0) == (count == 4)


def turned(steering, *, measured, speed=2.0, sample_time=0.2, slip=1.0, until=6.0):
    """Return the turning errors of a tractor that turns as by one angle of its wheels and measures another, degrees."""
    error, yaw, errors = TurningError(1.4, sample_time), 3.0, []
    for _ in range(round(until / sample_time)):
        now = SimpleNamespace(speed=speed, tractor_steering=measured * DEGREE)
        estimate = SimpleNamespace(longitudinal_slip=slip, tractor=SimpleNamespace(yaw=math.remainder(yaw, math.tau)))
        errors.append(error.update(SimpleNamespace(measurement=now, estimate=estimate)) / DEGREE)
        yaw += slip * speed * sample_time * math.tan(steering * DEGREE) / 1.4
    return errors


@pytest.mark.parametrize(("speed", "known_after"), [(0.5, 2.0), (1.0, 1.0), (2.0, 1.0), (-1.0, math.inf)])
@pytest.mark.parametrize("sample_time", [0.05, 0.2])
def test_the_error_is_the_angle_that_is_missing(speed, known_after, sample_time):
    errors = turned(5.0, measured=1.0, speed=speed, sample_time=sample_time)
    unknown = sum(map(math.isnan, errors))
    assert unknown == (len(errors) if math.isinf(known_after) else round(known_after / sample_time))
    if unknown < len(errors):
        assert errors[unknown:] == pytest.approx([4.0] * (len(errors) - unknown), abs=0.02)
        assert turned(-8.0, measured=-8.0, slip=0.8)[-1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("wheelbase", [1.4, 2.8])
def test_a_yaw_that_is_corrected_while_the_first_metres_are_driven_is_no_error_of_the_wheels(wheelbase):
    """By 3 degrees, which is as unsure as a heading may be when driving begins."""
    error, large = TurningError(wheelbase, 0.2), []
    for count in range(20):
        now = SimpleNamespace(speed=1.0, tractor_steering=0.0)
        yaw = 3.0 * DEGREE * min(count / 5, 1.0)
        error.update(
            SimpleNamespace(
                measurement=now, estimate=SimpleNamespace(longitudinal_slip=1.0, tractor=SimpleNamespace(yaw=yaw))
            )
        )
        large.append(error.is_large)
    assert not any(large)


@pytest.mark.parametrize(("measured", "speed"), [(math.nan, 2.0), (1.0, 0.05)])
def test_of_an_unknown_angle_or_a_standing_tractor_there_is_none(measured, speed):
    assert all(map(math.isnan, turned(5.0, measured=measured, speed=speed, until=60.0)))


@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        ("hitch-drifts", Cause.TRAILER_CONTRADICTS),
        ("joint-angle-drifts", Cause.TRAILER_CONTRADICTS),
        ("angle-drifts", Cause.STEERING_CONTRADICTS),
    ],
)
def test_a_drive_whose_sensor_drifts_ends_near_its_line_and_says_why(fault, cause):
    """Without it the hitch sensor takes the vehicle 1.3 m from its line, the front wheels' 0.5 m."""
    configuration = load_configuration(
        "articulated", ["speed=1.2", "safety.engage.wiggle_test=false", "safety.engage.fixed=1.0"]
    )
    path, _ = build_path(configuration)
    rehearsal = Rehearsal(configuration, path, 1, configuration.safety)
    while rehearsal.time < 18.0:
        rehearsal.advance()
    assert rehearsal.gate_state.state is SupervisorState.ACTIVE
    FAULTS[fault].begin(rehearsal.machine)
    farthest = 0.0
    while rehearsal.gate_state.state not in (SupervisorState.STOPPED, SupervisorState.FAULT):
        assert rehearsal.time < 40.0
        rehearsal.advance()
        poses = (rehearsal.machine.world.truth.tractor, rehearsal.machine.world.truth.trailer)
        farthest = max(farthest, *(abs(path.project(pose.x, pose.y, 0.0, 60.0)[1]) for pose in poses))
    assert cause in [BY_CODE[code] for code in rehearsal.loop._controller._faults.notices if code]
    assert farthest < 0.25
