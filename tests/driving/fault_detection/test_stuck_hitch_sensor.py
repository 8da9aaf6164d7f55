"""Stuck hitch sensor: an estimate that follows it hardly turns; wheels and joint show that the trailer does."""

import math

import pytest

from drawbar.driving.fault_detection.stuck_hitch_sensor import StuckHitchSensor

DEGREE = math.pi / 180.0
STEP = 0.04 * DEGREE
"""resolution of the sensor, rad"""
USUAL = 60
"""samples in which each value is another one"""


def seen(simulated, *, usual=1, resolution=STEP, repeats=30):
    """Return after how many repetitions a sensor is seen as stuck, infinity: never.

    simulated(k): angle by wheels and joint at repetition k, degrees; usual: samples that usually show the same angle.
    """
    sensor, value = StuckHitchSensor(0.15), 0.0
    for i in range(USUAL):
        value = resolution * (i // usual % 2 + 1)
        assert not sensor.update(value, 0.0, 0.1 * DEGREE, moves=True)
    for k in range(repeats):
        if sensor.update(value, 0.0, simulated(k) * DEGREE, moves=True):
            return k
    return math.inf


def test_a_small_turn_by_wheels_and_joint_is_enough_for_one_that_hardly_ever_repeats_itself():
    assert seen(lambda k: 0.1 * k) == 6
    assert seen(lambda k: -0.3 * k) == 3


@pytest.mark.parametrize("repetitions", [30, 300])
def test_one_that_rests_where_nothing_turns_is_right(repetitions):
    assert seen(lambda k: 0.1 + 0.2 * (k % 3), repeats=repetitions) == math.inf


def test_a_coarse_one_is_right():
    assert seen(lambda k: 0.1 * k, resolution=0.4 * DEGREE) == 10
    assert seen(lambda k: 0.9 * (k % 2), resolution=1.0 * DEGREE) == math.inf
    assert seen(lambda k: 0.1 * k, usual=6) == math.inf


def test_a_simulation_that_began_anew_meanwhile_tells_nothing():
    assert seen(lambda k: math.nan if k == 3 else 0.0 if k < 3 else 5.0) == math.inf


def test_a_vehicle_that_stands_repeats_every_angle():
    sensor = StuckHitchSensor(0.15)
    for i in range(USUAL):
        sensor.update(STEP * (i % 2), 0.0, 0.0, moves=True)
    assert not any(sensor.update(STEP, 0.0, 0.1 * k * DEGREE, moves=False) for k in range(30))
