"""Mirrored steering: sensor and motor of the front wheels are both the wrong way round."""

import math

import numpy as np
import pytest
from fixes import fixes_of

from drawbar.config import load_configuration
from drawbar.driving.fault_detection.mirrored_steering import MirroredSteering
from drawbar.driving.stand_in.rehearsal import Rehearsal
from drawbar.machine.stand_in.breaking import measure_otherwise, steer_otherwise
from drawbar.messages import SupervisorState
from drawbar.safety.causes import BY_CODE, Cause
from drawbar.simulation import build_path
from drawbar.vehicle.parameters import Mast, Masts, VehicleParameters

DEGREE = math.pi / 180.0


def found(
    steering,
    *,
    sign=1.0,
    speed=1.0,
    sample_time=0.2,
    until=30.0,
    ahead=0.0,
    disturbance=None,
    yaw=math.nan,
    late=0.1,
    suspected=False,
):
    """Drive with front wheels at angles of time; return when it is found that they are mirrored, and whether at last.

    `sign` of what is measured; `disturbance` of the course by the ground, rad, as a function of time.
    """
    vehicle = VehicleParameters(masts=Masts(tractor=Mast(forward=ahead)))
    detector, rng, first, heading = MirroredSteering(vehicle, sample_time), np.random.default_rng(2), math.inf, 3.0
    for k in range(round(until / sample_time)):
        time, angle = k * sample_time, steering(k * sample_time)
        curvature = math.tan(angle) / vehicle.wheelbase
        course = heading + math.atan(ahead * curvature) + rng.normal(0.0, 0.01 / speed)
        course += disturbance(time) if disturbance is not None else 0.0
        values = {"epoch": round((1.0 + time) * 1e9)}
        values |= {"time": values["epoch"] + round(late * 1e9)}
        values |= {"tractor_speed": speed, "tractor_course": math.remainder(course, math.tau), "tractor_yaw": yaw}
        detector.receive_fixes(fixes_of(**values), sign * angle, suspected=suspected)
        first = min(first, time) if detector.found else first
        heading += speed * curvature * sample_time
    return first, detector.found


def turn_in(time):
    return 8.0 * DEGREE * min(max(time - 10.0, 0.0), 1.0)


@pytest.mark.parametrize("sample_time", [0.05, 0.1, 0.2])
@pytest.mark.parametrize(("speed", "within"), [(1.0, 2.6), (2.0, 1.6), (3.0, 1.4)])
def test_it_is_found_soon_after_the_wheels_turn(speed, within, sample_time):
    first, at_last = found(turn_in, sign=-1.0, speed=speed, sample_time=sample_time)
    assert 10.0 < first <= 10.0 + within
    assert at_last


@pytest.mark.parametrize("ahead", [-0.6, 1.5])
def test_an_antenna_beside_the_rear_axle_changes_nothing(ahead):
    assert found(turn_in, sign=-1.0, ahead=ahead)[0] <= 13.0
    assert found(turn_in, ahead=ahead) == (math.inf, False)


@pytest.mark.parametrize(
    "steering",
    [
        turn_in,
        lambda t: 15.0 * DEGREE * math.sin(t),
        lambda t: 5.0 * DEGREE,
        lambda t: 0.0,
        lambda t: math.nan if t > 12.0 else turn_in(t),
    ],
)
@pytest.mark.parametrize("speed", [0.5, 1.0, 3.0])
def test_sound_steering_is_not_taken_for_it(steering, speed):
    assert found(steering, speed=speed) == (math.inf, False)


def test_ground_that_is_steered_against_is_not_taken_for_it():
    def against(time):
        return -4.0 * DEGREE * math.sin(1.5 * time)

    rough = found(against, speed=0.5, disturbance=lambda t: 10.0 * DEGREE * math.sin(1.5 * t))
    assert rough == (math.inf, False)


def test_it_stays_found_on_a_straight_until_the_opposite_shows():
    assert found(lambda t: turn_in(t) if t < 14.0 else 0.0, sign=-1.0)[1]
    signs = MirroredSteering(VehicleParameters(), 0.2)
    heading = 0.0
    for k in range(150):
        angle = 10.0 * DEGREE * math.sin(0.2 * k)
        values = {"tractor_speed": 1.0, "tractor_course": math.remainder(heading, math.tau), "tractor_yaw": math.nan}
        signs.receive_fixes(fixes_of(epoch=10**9 + k * 200_000_000, **values), -angle if k < 60 else angle)
        heading += 0.2 * math.tan(angle) / VehicleParameters().wheelbase
        assert signs.found or not 40 < k < 60
    assert not signs.found


def test_backwards_nothing_is_judged():
    assert found(turn_in, sign=-1.0, yaw=3.0 - math.pi, until=14.0) == (math.inf, False)
    assert found(turn_in, sign=-1.0, yaw=3.0, until=14.0)[1]


@pytest.mark.parametrize(("late", "is_found"), [(0.2, True), (0.5, False)])
def test_epochs_that_are_late_say_nothing(late, is_found):
    assert found(turn_in, sign=-1.0, late=late, until=14.0)[1] is is_found


@pytest.mark.parametrize(("sign", "is_found"), [(-1.0, True), (1.0, False)])
def test_at_slow_speed_it_is_found_where_it_is_suspected(sign, is_found):
    def steering(time):
        return 12.0 * DEGREE * min(max(time - 10.0, 0.0) / 3.0, 1.0)

    assert found(steering, sign=sign, speed=0.5, until=14.6)[0] == math.inf
    first, at_last = found(steering, sign=sign, speed=0.5, until=14.6, suspected=True)
    assert (first < 14.6, at_last) == (is_found, is_found)


def mirrored_rehearsal(speed):
    configuration = load_configuration(
        "articulated", [f"speed={speed}", "safety.engage.wiggle_test=false", "safety.engage.fixed=1.0"]
    )
    path, _ = build_path(configuration)
    rehearsal = Rehearsal(configuration, path, 1, configuration.safety)
    measure_otherwise(rehearsal.machine, "tractor", lambda true: -true, loop=False)
    steer_otherwise(rehearsal.machine, "tractor", lambda wanted, true: -wanted)
    return rehearsal, path


def reported(rehearsal):
    return [BY_CODE[code] for code in rehearsal.loop._controller._faults.notices if code]


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0])
def test_a_drive_with_it_is_released_and_says_why(speed):
    """That the tractor does not turn as its wheels are measured may show before it is clear that they are mirrored."""
    rehearsal, path = mirrored_rehearsal(speed)
    while rehearsal.gate_state is None or rehearsal.gate_state.state is not SupervisorState.FAULT:
        rehearsal.advance()
        assert rehearsal.time < 30.0
    assert BY_CODE[rehearsal.gate_state.cause] in (Cause.STEERING_CONTRADICTS, Cause.STEERING_MIRRORED)
    truth = rehearsal.machine.world.truth.tractor
    assert abs(path.project(truth.x, truth.y, 0.0, 20.0)[1]) < 0.25
    list(rehearsal.run(5.0))
    assert (Cause.STEERING_MIRRORED in reported(rehearsal)) == (speed >= 1.0)  # slower it does not turn far enough
    assert Cause.TRAILER_CONTRADICTS not in reported(rehearsal)
    assert rehearsal.gate_state.cause in rehearsal.gate_state.refusals
