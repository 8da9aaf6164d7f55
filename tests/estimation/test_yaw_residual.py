"""The yaw residual: a wrong hitch angle departs from the yaw rate, slipping wheels, zeros and noise do not."""

import math

import numpy as np
import pytest
from alone import Alone
from c_signals import Real

from drawbar.codegen import Unit
from drawbar.geometry import Floats

UNIT = """
#include "yaw_residual.h"
#include "unit.h"
struct component { struct yaw_residual residual; double departure; };
#define COMPONENT_FIELDS FIELD(component, departure, 0, 1, 0, 0)
int UNIT(update)(struct component *component, double yaw, double rate, double elapsed)
{
    yaw_residual_update(&component->residual, yaw, rate, elapsed);
    component->departure = yaw_residual_departure(&component->residual);
    return 0;
}
"""
SAMPLE = 0.2
DEGREE = math.pi / 180.0
TIMES = SAMPLE * np.arange(200)
YAWS = 3.0 + np.sin(0.4 * TIMES)
"""they pass through pi"""
RATES = 0.4 * np.cos(0.4 * TIMES)


def departures(yaws: Floats, rates: Floats) -> Floats:
    """Return the residual at each sample, rad."""
    residual, seen = Alone(Unit(name="residual", source=UNIT, configure=lambda workspace: None)), []
    for yaw, rate in zip(yaws.tolist(), rates.tolist(), strict=True):
        residual.call("update", Real(math.remainder(yaw, 2.0 * math.pi)), Real(rate), Real(SAMPLE))
        seen.append(float(residual.live.array("departure").item()))
    return np.array(seen)


def textbook(yaws: Floats, rates: Floats) -> Floats:
    """Return the same by the difference of both as a whole, not wrapped anywhere."""
    difference = yaws - yaws[0] - np.concatenate([[0.0], SAMPLE * np.cumsum(0.5 * (rates[1:] + rates[:-1]))])
    level = mean = largest = known = 0.0
    seen = []
    for each in difference.tolist():
        off, known = each - level, known + SAMPLE
        level += (1.0 - math.exp(-SAMPLE / min(3.0, known))) * off
        mean += (1.0 - math.exp(-SAMPLE / 0.5)) * (off - mean)
        largest = max(math.exp(-SAMPLE / 5.0) * largest, abs(mean))
        seen.append(largest if known > 3.0 else math.nan)
    return np.array(seen)


def test_it_is_the_departure_of_the_whole_difference_from_its_slow_mean() -> None:
    yaws = YAWS + np.random.default_rng(1).normal(0.0, 1.5 * DEGREE, YAWS.size)
    np.testing.assert_allclose(departures(yaws, RATES), textbook(yaws, RATES), atol=1e-9)


def test_zeros_bias_and_noise_are_below_what_a_wrong_hitch_angle_makes() -> None:
    noise = np.random.default_rng(2).normal(0.0, 1.0 * DEGREE, YAWS.size)
    sound = departures(YAWS + 3.0 * DEGREE + noise, RATES + 0.2 * DEGREE)
    assert np.nanmax(sound[50:]) < 2.6 * DEGREE
    wrong = departures(YAWS + noise + np.where(TIMES > 20.0, 5.0 * DEGREE, 0.0), RATES)
    assert (wrong[(TIMES > 20.5) & (TIMES < 23.0)] > 2.6 * DEGREE).all()


def test_single_missing_fixes_are_bridged_and_longer_gaps_begin_it_anew() -> None:
    yaws = YAWS.copy()
    yaws[50] = math.nan
    assert np.isfinite(departures(yaws, RATES)[20:]).all()
    yaws[50:60] = math.nan
    seen = departures(yaws, RATES)
    assert np.isfinite(seen[20:55]).all()
    assert np.isnan(seen[56:74]).all()
    assert np.isfinite(seen[80:]).all()


@pytest.mark.parametrize("missing", ["yaw", "rate"])
def test_without_yaw_or_yaw_rate_there_is_no_residual(missing: str) -> None:
    nothing = np.full(YAWS.size, math.nan)
    assert np.isnan(departures(*((nothing, RATES) if missing == "yaw" else (YAWS, nothing)))).all()
