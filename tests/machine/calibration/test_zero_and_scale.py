"""Zero and scale of a wheel-angle sensor from simulated driving with known truth."""

import math
from dataclasses import replace

import numpy as np
import pytest

from drawbar.machine.calibration.calibrated import Calibrated
from drawbar.machine.calibration.scale import Circle, Scale, scale_from_circles
from drawbar.machine.calibration.zero import zero_from_straight

WHEELBASE = 2.0
SPAN = (600.0, 3400.0)
"""lowest and highest counts"""
RATE = 20.0
"""samples a second"""


def straight(
    seconds: float, *, speed: float = 1.2, weave: float = 0.02, turn: float = 0.0, seed: int = 0
) -> list[np.ndarray]:
    """Return times, counts, yaw rates and speeds of a driver who weaves; counts fall to the left, the zero is 2013."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, seconds, 1.0 / RATE)
    angles = weave * np.sin(0.7 * times + rng.uniform(0, 6)) + turn
    rates = speed * np.tan(angles) / WHEELBASE + rng.normal(0.0, 0.005, len(times))
    counts = np.round(2013.0 - 2400.0 * angles + rng.normal(0.0, 3.0, len(times)))
    return [times, counts, rates, np.full(len(times), speed)]


@pytest.mark.parametrize("seed", range(5))
def test_the_zero_is_found_within_its_deviation_although_the_driver_weaves(seed: int) -> None:
    found = zero_from_straight(*straight(40.0, seed=seed))
    assert found.accepted, found.refusals
    assert abs(found.value - 2013.0) <= 3.0 * found.deviation + 0.2
    assert found.deviation < 3.0
    assert found.unit == "counts"


def test_a_zero_from_a_curve_or_from_too_short_a_way_is_refused() -> None:
    assert "mean curvature" in zero_from_straight(*straight(40.0, turn=0.05)).refusals[0]
    assert "m were driven" in zero_from_straight(*straight(20.0)).refusals[0]
    assert not zero_from_straight(*straight(40.0, speed=0.1)).accepted
    times, counts, rates, speeds = straight(60.0)
    counts[100:150], rates[400:420] = math.nan, math.inf
    assert zero_from_straight(times, counts, rates, speeds).value == pytest.approx(2013.0, abs=3.0)


ZERO = Calibrated(value=2013.0, deviation=1.0, unit="counts")


def circle(angle: float, *, cubic: float = 0.0, ratio: float = 1.0, seed: int = 0, seconds: float = 12.0) -> Circle:
    """Return a circle; counts fall to the left, 2400 a radian, by another ratio to the right."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, seconds, 1.0 / RATE)
    rates = np.full(len(times), 0.8 * math.tan(angle) / WHEELBASE) + rng.normal(0.0, 0.005, len(times))
    scale = 2400.0 * (ratio if angle > 0.0 else 1.0)
    counts = np.round(2013.0 - scale * (angle + cubic * angle**3) + rng.normal(0.0, 3.0, len(times)))
    return Circle(times=times, counts=counts, yaw_rates=rates, speeds=np.full(len(times), 0.8))


def circles(**options: float) -> list[Circle]:
    angles = [math.radians(degrees) for degrees in (-28, -18, -8, 8, 18, 28)]
    return [circle(angle, seed=i, **options) for i, angle in enumerate(angles)]  # type: ignore[arg-type]


def scale_of(given: list[Circle], zero: Calibrated = ZERO) -> Scale:
    return scale_from_circles(given, wheelbase=WHEELBASE, zero=zero, span=SPAN)


def test_counts_per_degree_and_direction_are_found_within_their_deviation() -> None:
    found = scale_of(circles()).counts_per_degree
    assert found.accepted, found.refusals
    assert abs(found.value + math.radians(2400.0)) <= 3.0 * found.deviation
    assert found.deviation < 0.02 * abs(found.value)


@pytest.mark.parametrize("cubic", [0.0, 0.6])
def test_the_polynomial_gives_the_angle_back(cubic: float) -> None:
    found = scale_of(circles(cubic=cubic))
    assert found.polynomial is not None
    for degrees in (-28, -18, -8, 0, 8, 18, 28):
        angle = math.radians(degrees)
        counts = 2013.0 - 2400.0 * (angle + cubic * angle**3)
        assert found.polynomial.read(counts).value == pytest.approx(angle, abs=math.radians(1.0))


def test_circles_that_are_too_few_too_short_or_not_held_are_refused() -> None:
    assert "circles to the left" in scale_of(circles()[:5]).counts_per_degree.refusals[0]
    assert not scale_of([]).counts_per_degree.accepted
    short = [*circles()[:5], circle(0.5, seconds=2.0)]
    assert any("3 s" in reason for reason in scale_of(short).counts_per_degree.refusals)
    refused = scale_of(circles(), replace(ZERO, refusals=("why",)))
    assert refused.counts_per_degree.refusals == ("the zero is not to be used: why",)
    mixed = circles()
    mixed[1] = circle(math.radians(-18), cubic=8.0)
    assert "no polynomial" in scale_of(mixed).counts_per_degree.refusals[0]
