"""Errors that last for seconds, of receivers, masts or by lateness, accuse no antenna; a jump among them does."""

import math
from dataclasses import replace

import numpy as np
import pytest
from screening_alone import (
    AHEAD,
    DEVIATION,
    LATER,
    LEFT,
    LENGTH,
    OK,
    REJECTED,
    STEP,
    Screening,
    drive,
    place,
    screened,
    shift,
)

from drawbar.estimation.settings import ScreeningSettings


def lasting(count, deviation, time, seed, direction=AHEAD):
    """Return errors (count, 4) of both antennas, first-order Gauss-Markov noise in a direction, m."""
    rng, kept = np.random.default_rng(seed), math.exp(-STEP / time)
    sizes = np.zeros((count, 2))
    sizes[0] = deviation * rng.normal(size=2)
    for k in range(1, count):
        sizes[k] = kept * sizes[k - 1] + deviation * math.sqrt(1.0 - kept**2) * rng.normal(size=2)
    return np.outer(sizes, direction).reshape(count, 4)


@pytest.mark.parametrize("time", [1.0, 10.0, 60.0])
def test_errors_that_last_for_seconds_accuse_no_antenna(time):
    wrong = []
    for seed in range(10):
        measurements = drive(700, lasting(700, DEVIATION, time, seed), noise=0.005, seed=seed)
        wrong += [result.fixes != (OK, OK) for result in screened(measurements)]
    assert np.mean(wrong) <= 0.01


def test_fixes_of_masts_that_sway_pass_and_count_for_less():
    wrong, deviations = [], []
    for seed in range(10):
        sway = lasting(700, 0.06, 1.0, seed, LEFT)
        results = screened(drive(700, sway, seed=seed))[LATER:]
        wrong += [result.fixes != (OK, OK) for result in results]
        deviations += [result.measurement.tractor_fix_deviation for result in results[300:]]
    assert np.mean(wrong) <= 0.01
    kept = math.exp(-STEP / 1.0)
    independent = 0.06 * math.sqrt((1.0 + kept) / (1.0 - kept))  # of which as many say as little
    assert 1.5 * 0.06 < np.mean(deviations) < independent


@pytest.mark.parametrize("missing", [(), ("tractor_roll",), ("trailer_roll",)])
def test_errors_that_last_count_as_sway_only_where_a_roll_is_not_measured(missing):
    measured = {name: 0.0 for name in ("tractor_roll", "trailer_roll") if name not in missing}
    sway = lasting(700, 0.06, 1.0, 0, LEFT)
    results = screened([replace(m, **measured) for m in drive(700, sway, seed=0)])
    weighed = np.isfinite([result.measurement.tractor_fix_deviation for result in results[400:]])
    assert set(weighed) == {bool(missing)}
    assert np.mean([result.fixes != (OK, OK) for result in results[LATER:]]) <= 0.01


def exposes(after, *, silent=None):
    """Return whether a shift of 12 cm ahead is found among fixes far better than stated, after so many samples.

    silent: sample in which a receiver says nothing.
    """
    measurements = drive(after + 40, shift(after + 40, after, after + 40, tractor=0.12 * AHEAD), noise=0.005)
    if silent is not None:
        measurements[silent] = replace(measurements[silent], tractor_x=math.nan)
    return any(result.exposed for result in screened(measurements))


def test_fixes_without_errors_that_last_are_learned_to_be_so():
    assert [exposes(LATER), exposes(600), exposes(600, silent=590)] == [False, True, True]


@pytest.mark.parametrize("size", [0.3, 1.0, 5.0])
@pytest.mark.parametrize("direction", [AHEAD, LEFT], ids=["ahead", "left"])
def test_a_jump_among_errors_that_last_is_masked_for_as_long_as_it_lasts(direction, size):
    for seed in range(5):
        jump = shift(300, LATER, 200, trailer=size * direction)
        results = screened(drive(300, jump + lasting(300, 0.02, 10.0, seed), noise=0.005, seed=seed))
        masked = np.array([result.fixes[1] is REJECTED for result in results])
        assert masked[LATER + 1 : 200].all()
        assert {result.fixes[0] for result in results} == {OK}


FAST = 2.0
"""a yaw rate, rad/s"""


def turned(rates, offsets, settings):
    """Return what becomes of exact fixes whose antennas disagree across by offsets (n,), m; rates (n,) in rad/s."""
    screening = Screening(settings, DEVIATION)
    half = 0.5 * np.outer(offsets, LEFT)
    measurements = drive(len(rates), np.hstack([-half, half]), noise=0.0)
    return [
        screening.screen(measurement, place(k), rate)
        for k, (measurement, rate) in enumerate(zip(measurements, rates.tolist(), strict=True))
    ]


def test_fixes_that_are_late_when_a_turn_begins_accuse_no_antenna():
    """The line of both is as far back as the lateness turns it, until the estimator has taken that up."""
    settings, samples = ScreeningSettings(), np.arange(200)
    begun = samples >= LATER
    offsets = settings.late * FAST * LENGTH * begun * (1.0 - 1.0 / settings.settling) ** np.maximum(samples - LATER, 0)
    assert {result.fixes for result in turned(FAST * begun, offsets, settings)} == {(OK, OK)}
    unaware = settings.model_copy(update={"late": 0.0})
    assert any(result.exposed for result in turned(FAST * begun, offsets, unaware))


def test_a_turn_that_lasts_excuses_nothing():
    settings, samples = ScreeningSettings(), np.arange(300)
    offsets = 0.15 * (samples >= LATER + 5 * settings.settling)
    rates = FAST * (samples >= LATER)
    exposed = [k for k, result in enumerate(turned(rates, offsets, settings)) if result.exposed]
    assert 0 <= exposed[0] - LATER - 5 * settings.settling <= settings.memory
