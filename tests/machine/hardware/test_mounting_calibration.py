"""Mounting roll and antenna places from simulated driving with known truth."""

import math
from dataclasses import replace

import numpy as np
import pytest

from drawbar.machine.hardware.mounting_calibration import AntennaPlace, BodyDrive, antenna_place, mounting_roll


def ways(
    bias: float, *, height: float = 2.5, seconds: float = 60.0, seed: int = 0
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return times and cross-track errors there and back, with errors of RTK that last 5 s, and a track 4 cm off."""
    rng = np.random.default_rng(seed)
    made = []
    for sign in (1.0, -1.0):
        times = np.arange(0.0, seconds, 0.1)
        error = np.zeros(len(times))
        for k in range(1, len(times)):
            error[k] = math.exp(-0.1 / 5.0) * error[k - 1] + rng.normal(0.0, 0.01 * math.sqrt(2 * 0.1 / 5.0))
        made.append((times, 0.04 + sign * height * math.sin(bias) + error))
    return made


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("degrees", [-2.0, 0.0, 0.3, 3.0])
def test_the_mounting_roll_is_found_within_its_deviation(degrees: float, seed: int) -> None:
    found = mounting_roll(*ways(math.radians(degrees), seed=seed), height=2.5)
    assert found.accepted, found.refusals
    assert abs(found.value - math.radians(degrees)) <= 3.5 * found.deviation
    assert found.deviation < math.radians(0.2)


def test_a_mounting_roll_that_cannot_be_is_refused() -> None:
    assert "apart" in mounting_roll(*ways(math.radians(12.0)), height=2.5).refusals[0]
    assert "height" in mounting_roll(*ways(0.01), height=math.nan).refusals[0]
    assert "drive 20 s" in mounting_roll(*ways(0.01, seconds=9.0), height=2.5).refusals[0]


def drive(
    forward: float,
    left: float,
    *,
    yaw_offset: float = 0.03,
    factor: float = 1.04,
    turns: tuple[float, ...] = (0.0, 0.25, 0.0, -0.25, 0.0),
    seed: int = 0,
) -> BodyDrive:
    """Return fifteen seconds of each yaw rate, with noise."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, 15.0 * len(turns), 0.1)
    rates = np.array(turns)[(times / 15.0).astype(int)]
    yaw = 0.7 + np.cumsum(rates) * 0.1
    speed = np.full(len(times), 1.0)
    along, across = speed - rates * left, rates * forward
    velocity = np.column_stack([along * np.cos(yaw) - across * np.sin(yaw), along * np.sin(yaw) + across * np.cos(yaw)])
    return BodyDrive(
        times=times,
        velocities=velocity + rng.normal(0.0, 0.02, velocity.shape),
        yaws=yaw + yaw_offset,
        yaw_rates=rates + rng.normal(0.0, 0.002, len(times)),
        wheel_speeds=speed / factor + rng.normal(0.0, 0.02, len(times)),
    )


def within(found: AntennaPlace, **truth: float) -> None:
    for name, true in truth.items():
        value = getattr(found, name)
        assert value.accepted, value.refusals
        assert abs(value.value - true) <= 3.0 * value.deviation + 0.005
        assert value.deviation < 0.05


@pytest.mark.parametrize(("forward", "left"), [(1.2, 0.0), (0.3, 0.15), (-0.8, -0.4)])
@pytest.mark.parametrize("seed", [0, 1])
def test_an_antenna_s_place_is_found_within_its_deviation(forward: float, left: float, seed: int) -> None:
    found = antenna_place(drive(forward, left, seed=seed))
    within(found, forward=forward, left=left, yaw_offset=0.03, wheel_factor=1.04)


def test_without_a_wheel_speed_the_place_to_the_side_is_not_observable() -> None:
    found = antenna_place(replace(drive(1.2, 0.3), wheel_speeds=None))
    within(found, forward=1.2, yaw_offset=0.03)
    assert math.isnan(found.left.value)
    assert "not observable" in found.left.refusals[0]
    assert not found.wheel_factor.accepted


def test_turns_to_one_side_alone_or_none_are_refused() -> None:
    one_sided = antenna_place(drive(1.2, 0.3, turns=(0.0, 0.25, 0.0)))
    assert "turning right" in one_sided.left.refusals[0]
    straight = antenna_place(drive(1.2, 0.3, turns=(0.0, 0.0)))
    assert {"left", "right"} <= set(" ".join(straight.forward.refusals).split())
    short = drive(1.0, 0.0)
    cut = BodyDrive(
        times=short.times[:5],
        velocities=short.velocities[:5],
        yaws=short.yaws[:5],
        yaw_rates=short.yaw_rates[:5],
        wheel_speeds=None,
    )
    assert "record a minute" in antenna_place(cut).forward.refusals[0]


def test_missing_velocities_are_left_out() -> None:
    given = drive(1.2, 0.3)
    given.velocities[200:240] = math.nan
    within(antenna_place(given), forward=1.2, left=0.3)
