"""Reversed hitch sensor: one that says the opposite of what the motion makes of the hitch angle."""

import math
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest

from drawbar.driving.fault_detection.reversed_hitch_sensor import ReversedHitchSensor
from drawbar.driving.fault_detection.simulated_hitch_angle import SimulatedHitchAngle
from drawbar.signals import SolverStatus
from drawbar.vehicle.parameters import VehicleParameters

DEGREE = math.pi / 180.0
VEHICLE = VehicleParameters()
SPEED = 2.0
Sensor = Callable[[float, float], float]
"""what it says of a true hitch angle at a time, rad, s"""


def steady(steering: float) -> float:
    """Return the hitch angle on a circle with a straight joint, by the triangles of the circle's centre, rad."""
    radius, ahead = VEHICLE.wheelbase / math.tan(steering), VEHICLE.free_joint_offset
    length = VEHICLE.drawbar_length + VEHICLE.trailer_length
    return math.atan(ahead / radius) + math.asin(length / math.copysign(math.hypot(radius, ahead), radius))


def seen(sensor: Sensor, *, steering: float = 6.0 * DEGREE, sample_time: float = 0.2, speed: float = SPEED) -> float:
    """Return when a sensor is first seen as reversed within 40 s on a circle, s; infinity: never."""
    detector, rng = ReversedHitchSensor(sample_time), np.random.default_rng(4)
    simulation = SimulatedHitchAngle(VEHICLE, sample_time)
    slips = SimpleNamespace(
        longitudinal_slip=1.0, tractor_slip=1.0, steering_offset=0.0, tractor_crab=0.0, trailer_crab=0.0,
        status=SolverStatus.SOLVED,
    )  # fmt: skip
    true = steady(steering) if steering else 0.0
    for k in range(round(40.0 / sample_time)):
        time = k * sample_time
        told = sensor(true, time) + rng.normal(0.0, 1.0 * DEGREE)
        measured = SimpleNamespace(hitch_angle=told, trailer_steering=0.0, tractor_steering=steering, speed=speed)
        simulated = simulation.update(measured, slips)
        if detector.update(told, simulated):
            return time
    return math.inf


@pytest.mark.parametrize("sample_time", [0.05, 0.1, 0.2])
@pytest.mark.parametrize("steering", [-4.0, 6.0])
def test_a_sensor_that_turns_round_is_seen_within_its_span(sample_time: float, steering: float) -> None:
    turned = seen(lambda true, t: -true if t > 20.0 else true, steering=steering * DEGREE, sample_time=sample_time)
    assert 20.0 < turned <= 20.7


def test_a_sensor_that_is_reversed_from_the_start_is_seen_once_it_moves() -> None:
    assert seen(lambda true, t: -true) < 4.0
    assert seen(lambda true, t: -true, speed=0.0) == math.inf


@pytest.mark.parametrize(
    "sensor",
    [
        pytest.param(lambda true, t: true, id="right"),
        pytest.param(lambda true, t: true + 4.0 * DEGREE, id="offset"),
        pytest.param(lambda true, t: true - 4.0 * DEGREE, id="offset to the other side"),
        pytest.param(lambda true, t: 0.0 if t > 20.0 else true, id="stuck in the middle"),
        pytest.param(lambda true, t: math.nan if t > 20.0 else true, id="missing"),
        pytest.param(lambda true, t: -85.0 * DEGREE if round(t / 0.2) % 9 == 8 else true, id="single false ones"),
    ],
)
@pytest.mark.parametrize("steering", [0.0, 2.0, 6.0])
def test_what_is_not_reversed_is_not_taken_for_it(sensor: Sensor, steering: float) -> None:
    assert seen(sensor, steering=steering * DEGREE) == math.inf


def test_where_the_motion_says_little_usually_a_small_contradiction_is_none() -> None:
    def rough(true: float, t: float) -> float:
        return true + 7.0 * DEGREE * math.sin(2.0 * t)

    assert seen(rough, steering=3.0 * DEGREE) == math.inf
    assert seen(lambda true, t: rough(true, t) if t > 20.0 else true, steering=3.0 * DEGREE) < 40.0
