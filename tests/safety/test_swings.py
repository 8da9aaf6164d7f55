"""Oscillations of errors or steering slow a run, and end it."""

import math
from collections.abc import Iterable

import numpy as np
import pytest
from sanity import SAMPLE, Sanity, beside, estimate, measurement

from drawbar.safety.sanity import SanitySettings
from drawbar.signals import Status

LONGEST_SWING = 8.0


def watched(errors: Iterable[float], steerings: Iterable[float] | None = None) -> list[tuple[int, float]]:
    """Return status and share after each sample with these errors of the tractor, or these front wheels."""
    sanity, values = Sanity(), list(errors)
    angles = list(steerings) if steerings is not None else [0.0] * len(values)
    return [
        sanity.look(measurement(k), estimate(steering=angle, speed=1.0), beside(error), beside(0.0))
        for k, (error, angle) in enumerate(zip(values, angles, strict=True))
    ]


def sine(samples: int, period: float, size: float = 1.0) -> list[float]:
    return [size * math.sin(2.0 * math.pi * SAMPLE * k / period) for k in range(samples)]


@pytest.mark.parametrize("period", [1.6, 4.0, 10.0])
def test_an_oscillation_slows_within_two_periods_and_then_ends_the_run(period: float) -> None:
    for seen in (watched(sine(200, period, 0.3)), watched([0.0] * 200, sine(200, period, 0.3))):
        slow = next(k for k, (_, share) in enumerate(seen) if share < 1.0)
        assert SAMPLE * slow <= 2.0 * period + SAMPLE
        end = next(k for k, (status, _) in enumerate(seen) if status)
        assert seen[end][0] == Status.OSCILLATION
        assert slow < end
        assert SAMPLE * end <= 3.7 * period + SAMPLE


def test_a_growing_oscillation_ends_the_run_too() -> None:
    seen = watched([0.05 * 1.02**k * value for k, value in enumerate(sine(300, 4.0))])
    assert seen[-1][0] == Status.OSCILLATION


@pytest.mark.parametrize(
    "errors",
    [
        [0.1 * value for value in sine(300, 4.0)],  # below the threshold
        [1.5 * math.exp(-k / 12.0) * value for k, value in enumerate(sine(300, 5.0))],  # dies away
        sine(300, 20.0),  # so slow that it is the line
        [0.3 + 0.2 * value for value in sine(300, 4.0)],  # on one side
        np.random.default_rng(0).normal(0.0, 0.04, 300).tolist(),
    ],
)
def test_what_dies_away_or_stays_small_is_no_oscillation(errors: list[float]) -> None:
    assert {status for status, _ in watched(errors)} == {0}
    assert min(share for _, share in watched(errors)) == 1.0


def test_small_swings_of_the_front_wheels_as_of_play_slow_after_three_periods_and_never_end_the_run() -> None:
    """Peaks of 7°, as of wheels with a play of 4° to either side; the second time they are not driven out any more."""
    settings, period = SanitySettings(), 8.0
    spell = [0.13 * value for value in sine(round(4.0 * period / SAMPLE), period)]
    calm = [0.0] * round(2.0 * settings.swing_calm / SAMPLE)
    angles = [*spell, *calm, *spell, *calm, *spell, *calm]
    seen = watched([0.0] * len(angles), angles)
    shares, again = [share for _, share in seen], len(spell) + len(calm)
    assert {status for status, _ in seen} == {0}
    assert set(shares) == {1.0, settings.swing_share}
    assert 2.5 * period <= SAMPLE * shares.index(settings.swing_share) <= 3.5 * period
    assert set(shares[again - 10 : again]) == {1.0}
    assert set(shares[again + len(spell) :]) == {settings.swing_share}


@pytest.mark.parametrize(
    "angles",
    [
        [0.09 * value for value in sine(400, 8.0)],  # below the threshold
        [0.13 * value for value in sine(100, 8.0)] + [0.0] * 100,  # five half waves
        [0.19 * math.exp(-k / 60.0) * value for k, value in enumerate(sine(400, 8.0))],  # dies away
        np.random.default_rng(0).normal(0.0, 0.03, 400).tolist(),
    ],
)
def test_fewer_or_smaller_swings_of_the_front_wheels_are_no_oscillation(angles: list[float]) -> None:
    assert set(watched([0.0] * len(angles), angles)) == {(0, 1.0)}


def test_small_swings_do_not_slow_what_oscillates_already_any_further() -> None:
    settings, period = SanitySettings(), 8.0
    large, calm = sine(45, 4.0, 0.3), [0.0] * round(0.5 * settings.swing_calm / SAMPLE)
    small = [0.13 * value for value in sine(round(4.0 * period / SAMPLE), period)]
    errors, angles = [*large, *calm, *[0.0] * len(small)], [*[0.0] * len([*large, *calm]), *small]
    assert watched(errors, angles)[-1] == (0, settings.swing_share)


def test_what_has_oscillated_and_calms_down_is_tried_once_more() -> None:
    settings = SanitySettings()
    swung, calm = sine(45, 4.0, 0.3), [0.0] * round(2.0 * settings.swing_calm / SAMPLE)
    shares = [share for _, share in watched([*swung, *calm, *swung, *calm])]
    first, second = shares.index(settings.swing_share), len(swung) + len(calm)
    tried = shares.index(1.0, first)
    assert settings.swing_calm <= SAMPLE * (tried - len(swung)) <= settings.swing_calm + LONGEST_SWING
    assert set(shares[tried:second]) == {1.0}
    assert shares[-1] == settings.swing_share


def test_what_oscillates_again_before_it_is_calm_stays_slower_still() -> None:
    settings = SanitySettings()
    swung, calm = sine(45, 4.0, 0.3), [0.0] * round(0.5 * settings.swing_calm / SAMPLE)
    assert watched([*swung, *calm, *swung, *calm * 6])[-1] == (0, settings.swing_share**2)


def test_a_vehicle_that_stands_shows_no_calm() -> None:
    sanity, settings = Sanity(), SanitySettings()
    for k, error in enumerate([*sine(45, 4.0, 0.3), *[0.0] * round(2.0 * settings.swing_calm / SAMPLE)]):
        speed = 1.0 if k < 45 else 0.0
        seen = sanity.look(measurement(k, speed), estimate(speed=speed), beside(error), beside(0.0))
    assert seen == (0, settings.swing_share)


@pytest.mark.parametrize("offset", [0.12, -0.12])
def test_an_oscillation_about_a_place_beside_the_line_ends_the_run_a_period_later_at_most(offset: float) -> None:
    """Peaks of 42 and 18 cm in turn: each is as large as the last one on its side; the first two have none there."""
    about_the_line, beside_it = (watched(middle + each for each in sine(200, 4.0, 0.3)) for middle in (0.0, offset))
    ends = [next(k for k, (status, _) in enumerate(seen) if status) for seen in (about_the_line, beside_it)]
    assert beside_it[ends[1]][0] == Status.OSCILLATION
    assert ends[1] <= ends[0] + 4.0 / SAMPLE


@pytest.mark.parametrize("offset", [0.03, -0.03])
def test_an_oscillation_that_is_beyond_the_threshold_on_one_side_alone_ends_the_run(offset: float) -> None:
    """Peaks of 19 and 13 cm in turn, where 15 is the threshold."""
    seen = watched(offset + each for each in sine(200, 4.0, 0.16))
    assert {status for status, _ in seen} == {0, Status.OSCILLATION}
    assert {status for status, _ in watched(offset + each for each in sine(200, 4.0, 0.14))} == {0}


@pytest.mark.parametrize("offset", [0.0, 0.1, -0.1])
@pytest.mark.parametrize("left", [0.3, 0.6])
def test_what_dies_away_is_no_oscillation_wherever_it_settles(left: float, offset: float) -> None:
    fading = [
        offset + 1.5 * math.exp(math.log(left) * k * SAMPLE / 2.0) * math.sin(math.pi * k * SAMPLE / 2.0)
        for k in range(200)
    ]
    assert {status for status, _ in watched(fading)} == {0}


def test_steering_along_a_curve_is_no_swing() -> None:
    sanity, wheelbase = Sanity(), 1.4
    for k, curvature in enumerate(sine(200, 6.0, 0.25)):
        angle = math.atan(wheelbase * curvature)
        seen = sanity.look(measurement(k), estimate(steering=angle), beside(0.0, curvature), beside(0.0))
        assert seen == (0, 1.0)
