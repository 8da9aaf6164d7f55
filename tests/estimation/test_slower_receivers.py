"""Receivers that report less often than samples are taken, or in turns, are screened as those of each sample are."""

import math
from dataclasses import replace

import numpy as np
import pytest
from screening_alone import DEVIATION, LEFT, NAMES, STEP, drive, place, screened, shift

from drawbar.estimation.settings import ScreeningSettings
from drawbar.signals import FixStatus


def sparse(measurements, every):
    """Return the measurements without the fixes of all samples but every so many."""
    nothing = dict.fromkeys(NAMES, math.nan)
    return [m if k % every == 0 else replace(m, **nothing) for k, m in enumerate(measurements)]


@pytest.mark.parametrize("every", [2, 3, 4])
def test_receivers_that_report_less_often_than_samples_are_taken_prevail_as_well(every):
    errors = np.zeros((240, 4))
    errors[120:] = 3.0
    restarts = [k for k, result in enumerate(screened(sparse(drive(240, errors), every))) if result.restart]
    patience = ScreeningSettings().patience / STEP
    assert restarts[0] == pytest.approx(120 + patience, abs=every)


def in_turns(measurements, antenna):
    """Return the measurements, of which every other one has the fix of that antenna (0, 1), the rest the other's."""
    nothing = [dict.fromkeys(names, math.nan) for names in (NAMES[2:], NAMES[:2])]
    return [replace(m, **nothing[(k + antenna) % 2]) for k, m in enumerate(measurements)]


@pytest.mark.parametrize("antenna", [0, 1])
def test_receivers_that_report_in_turns_prevail_as_well(antenna):
    errors = np.zeros((240, 4))
    errors[120:] = 3.0
    results = screened(in_turns(drive(240, errors), antenna))
    restarts = [k for k, result in enumerate(results) if result.restart]
    assert restarts[0] == pytest.approx(120 + ScreeningSettings().patience / STEP, abs=3)
    where = [getattr(results[restarts[0]].measurement, name) for name in NAMES]
    assert where == pytest.approx(np.ravel(place(restarts[0])) + 3.0, abs=5.0 * DEVIATION)


@pytest.mark.parametrize("antenna", [0, 1])
def test_a_small_lasting_jump_is_exposed_by_receivers_that_report_in_turns(antenna):
    jump = shift(400, 200, 280, trailer=0.14 * LEFT)
    results = screened(in_turns(drive(400, jump), antenna))
    masked = [k for k, result in enumerate(results) if result.fixes[1] is FixStatus.REJECTED]
    assert 200 < masked[0] <= 216
    assert sum(200 <= k < 280 for k in masked) > 30


@pytest.mark.parametrize("every", [2, 3])
def test_a_small_lasting_jump_is_exposed_by_receivers_that_report_less_often(every):
    jump = shift(400, 200, 280, trailer=0.14 * LEFT)
    results = screened(sparse(drive(400, jump), every))
    masked = [k for k, result in enumerate(results) if result.fixes[1] is FixStatus.REJECTED]
    assert 200 < masked[0] <= 200 + 8 * every
    assert sum(200 <= k < 280 for k in masked) > 80 // every - 10
