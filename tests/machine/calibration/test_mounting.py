"""Mounting roll and antenna places from simulated driving with known truth."""

import math
from dataclasses import replace

import numpy as np
import pytest
from serpentine import serpentine

from drawbar.machine.calibration.mounting import CurveDrive, antenna_place, mounting_roll


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


def drive(forward: float, left: float, **how: float) -> CurveDrive:
    times, x, y, speeds, angles = serpentine(forward, left, **how)
    return CurveDrive(times=times, x=x, y=y, wheel_speeds=speeds, front_wheels=angles)


@pytest.mark.parametrize(("forward", "left"), [(1.2, 0.0), (0.3, 0.15), (-0.8, -0.4)])
@pytest.mark.parametrize("seed", [0, 1])
def test_the_place_of_the_antenna_of_a_simulated_machine_is_found_within_its_deviation(forward, left, seed) -> None:
    found = antenna_place(drive(forward, left, seed=seed), wheelbase=1.4)
    for value, true in ((found.forward, forward), (found.left, left)):
        assert value.accepted, value.refusals
        assert abs(value.value - true) <= 2.0 * value.deviation
        assert value.deviation < 0.05


def test_slip_that_lasts_in_long_curves_is_part_of_the_deviation() -> None:
    """Each 90 s the wheels slip by another 2 % and the axle by another 4 % of the steering."""
    errors = []
    for seed in range(12):
        given = drive(1.2, 0.1, seconds=360.0, half=20.0, seed=seed)
        part = (given.times / 90.0).astype(int)
        slip, aside = 1.0 + np.array([[0.02], [0.04]]) * np.random.default_rng([seed, 9]).normal(size=(2, 5))
        slipping = replace(
            given, wheel_speeds=slip[part] * given.wheel_speeds, front_wheels=aside[part] * given.front_wheels
        )
        left = antenna_place(slipping, wheelbase=1.4).left
        errors.append((left.value - 0.1) / left.deviation)
    assert np.abs(errors).max() < 3.0
    assert np.sqrt(np.mean(np.square(errors))) < 1.3


def test_factor_and_offset_of_the_wheels_do_no_harm_and_gaps_are_left_out() -> None:
    given = drive(0.5, 0.1)
    x = np.where((given.times > 40.0) & (given.times < 48.0), np.nan, given.x)
    other = replace(
        given,
        x=x,
        wheel_speeds=1.06 * given.wheel_speeds,
        front_wheels=np.where(given.front_wheels > 0.0, 0.9, 1.1) * given.front_wheels + 0.02,
    )
    found = antenna_place(other, wheelbase=1.4)
    assert found.forward.value == pytest.approx(0.5, abs=2.0 * found.forward.deviation)
    assert found.left.value == pytest.approx(0.1, abs=2.0 * found.left.deviation)


def test_what_does_not_show_the_place_is_refused() -> None:
    one_sided = antenna_place(drive(1.2, 0.3, right=0.0), wheelbase=1.4)
    assert "turning right" in one_sided.left.refusals[0]
    assert "two minutes" in antenna_place(drive(1.0, 0.0, seconds=20.0), wheelbase=1.4).forward.refusals[0]
    slow = antenna_place(drive(1.0, 0.0, half=40.0, seconds=60.0), wheelbase=1.4)
    assert "deviation" in slow.forward.refusals[-1]
    given = drive(1.0, 0.0)
    standing = replace(given, x=np.zeros(len(given.times)), y=np.zeros(len(given.times)))
    assert "0 s of driving" in antenna_place(standing, wheelbase=1.4).forward.refusals[0]
    slipping = replace(given, wheel_speeds=given.wheel_speeds * (1.0 + 0.3 * np.sin(given.times)))
    assert "slip" in antenna_place(slipping, wheelbase=1.4).forward.refusals[0]
