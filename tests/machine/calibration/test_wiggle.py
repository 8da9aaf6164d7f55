"""The wiggle test: what it passes and what it refuses, on a closed loop whose truth is known."""

import math
import re

import numpy as np
import pytest

from drawbar.benchmark.simulated_actuators import SimulatedValve
from drawbar.machine.calibration.wiggle import Wiggle, wiggle_command, wiggle_test
from drawbar.machine.low_level.low_level import ActuateInput, LowLevel, SteeringAxis, TableSensor
from drawbar.machine.low_level.settings import PositionLoopSettings, ValveSettings

SENSOR = TableSensor(counts=(-1e4, 1e4), values=(-1.0, 1.0), lowest=-9e3, highest=9e3)


def followed(command: np.ndarray, *, seed: int = 0) -> np.ndarray:
    """Return what a valve under drawbar_actuate makes of set points at 50 Hz."""
    loop = LowLevel(front=SteeringAxis(sensor=SENSOR, loop=PositionLoopSettings(), limit=0.6))
    valve = SimulatedValve(ValveSettings(), full_rate=math.radians(25.0), stop=0.6, dead_time=0.04)
    rng, angles = np.random.default_rng(seed), []
    for k, wanted in enumerate(command.tolist()):
        angle = valve.angle + rng.normal(0.0, math.radians(0.1))
        given = ActuateInput(
            time=0.02 * k,
            measured_speed=0.5,
            counts=(1e4 * angle, 0.0, 0.0),
            steering=(wanted, 0.0),
            steer=(True, False),
        )
        valve.advance(loop.step(given).drives[0], 0.02)
        angles.append(angle)
    return np.array(angles)


TIMES = np.arange(0.0, 4.5, 0.02)
COMMAND = np.array([wiggle_command(time - 0.5) for time in TIMES.tolist()])


def late(angles: np.ndarray, seconds: float) -> np.ndarray:
    count = round(seconds / 0.02)
    return np.concatenate([np.zeros(count), angles[: len(angles) - count]])


def test_the_command_is_two_degrees_to_both_sides() -> None:
    assert [math.degrees(wiggle_command(time)) for time in (-0.1, 0.0, 0.99, 1.0, 1.99, 2.0, 9.0)] == pytest.approx(
        [0, 2, 2, -2, -2, 0, 0]
    )


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_sound_loop_passes(seed: int) -> None:
    found = wiggle_test(TIMES, COMMAND, followed(COMMAND, seed=seed))
    assert found.passed, found
    assert found.gain == pytest.approx(1.0, abs=0.1)
    assert found.delay == pytest.approx(0.4, abs=0.1)


ANGLES = followed(COMMAND)
REFUSED = {
    "other side": (-ANGLES, "the other side"),
    "too much": (1.6 * ANGLES, "gain 1.6"),
    "too little": (0.6 * ANGLES, "gain 0.6"),
    "late": (late(ANGLES, 0.4), "delay"),
    "stuck": (np.zeros(len(TIMES)), "of the command"),
    "noise": (math.radians(2.0) * np.random.default_rng(0).standard_normal(len(TIMES)), "command"),
    "another motion": (math.radians(4.0) * np.sin(3.0 * TIMES), "explains|other side|gain|command"),
    "nothing measured": (np.full(len(TIMES), math.nan), "samples: 0"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_wrong_is_refused_in_words(name: str) -> None:
    angles, words = REFUSED[name]
    found = wiggle_test(TIMES, COMMAND, angles)
    assert not found.passed
    assert re.search(words, found.refusals[0]), found


def test_reversed_and_late_is_not_taken_for_right() -> None:
    for delay in np.arange(0.0, 0.5, 0.1).tolist():
        found: Wiggle = wiggle_test(TIMES, COMMAND, -late(ANGLES, delay))
        assert not found.passed


def test_no_wiggle_or_times_out_of_order_are_refused() -> None:
    assert not wiggle_test(TIMES, np.zeros(len(TIMES)), ANGLES).passed
    assert not wiggle_test(TIMES[::-1], COMMAND, ANGLES).passed
