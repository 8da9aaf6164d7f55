"""Fixes beside the estimate: when they are believed again, after a loss or because the estimate is wrong."""

import math

import numpy as np
import pytest
from screening_alone import (
    AHEAD,
    DEVIATION,
    HEADING,
    LATER,
    LEFT,
    LENGTH,
    OK,
    REJECTED,
    STEP,
    Screening,
    drive,
    lost,
    place,
    screened,
    shift,
    toward,
)

from drawbar.estimation.settings import ScreeningSettings


def test_after_a_loss_the_gate_is_as_wide_as_dead_reckoning_is_wrong():
    """Ten seconds without a fix make room for one metre more."""
    for offset, accepted in ((0.8, True), (1.5, False)):
        north = (0.0, offset)
        measurements = lost(drive(200, shift(200, 150, 200, north, north)), 100, 150)
        assert (screened(measurements)[150].fixes == (OK, OK)) is accepted


def test_two_antennas_that_agree_with_each_other_prevail():
    results = screened(drive(200, shift(200, LATER, 200, (3.0, 3.0), (3.0, 3.0))))
    restarts = [k for k, result in enumerate(results) if result.restart]
    patience = round(ScreeningSettings().patience / STEP)
    assert restarts[0] == LATER + patience
    assert results[restarts[0]].fixes == (OK, OK)
    assert np.diff(restarts).tolist() == [2] * (len(restarts) - 1)  # nothing follows them here, and trust is gone
    assert {result.fixes for result in results[LATER : restarts[0]]} == {(REJECTED, REJECTED)}


@pytest.mark.parametrize("error", [0.4, -1.0])
def test_two_antennas_that_turn_the_vehicle_about_do_not_prevail_before_dead_reckoning_may_have_turned_as_much(error):
    """Both are as far from each other as they should be, and metres off, as false fixes may be."""
    errors = shift(600, LATER, 600, (3.0, 3.0), 3.0 + LENGTH * (AHEAD - toward(HEADING + error)))
    restarts = [k for k, result in enumerate(screened(drive(600, errors))) if result.restart]
    settings = ScreeningSettings()
    room = LENGTH * abs(math.sin(error)) - settings.length - settings.lateral * DEVIATION
    assert restarts[0] == pytest.approx(LATER + (room / settings.growth + settings.patience) / STEP, abs=5)
    assert restarts[0] > LATER + 4 * settings.patience / STEP


def test_two_antennas_that_contradict_each_other_do_not_prevail():
    results = screened(drive(200, shift(200, LATER, 200, (30.0, 0.0), (0.0, -20.0))))
    assert not any(result.restart for result in results)
    assert {result.fixes for result in results[LATER:]} == {(REJECTED, REJECTED)}


@pytest.mark.parametrize("error", [0.3, math.pi / 4, math.pi / 2, math.pi, -math.pi / 2])
def test_a_yaw_that_was_wrong_from_the_start_is_overruled_by_one_antenna(error):
    screening = Screening(ScreeningSettings(), DEVIATION)
    tractor = np.array(place(0)[0])
    trailer = tractor - LENGTH * toward(HEADING + error)
    expected = (tuple(tractor.tolist()), tuple(trailer.tolist()))
    results = [screening.screen(measurement, expected) for measurement in drive(6, speed=0.0)]
    assert [result.restart for result in results] == [False, True] * 3  # nothing follows it here: once more
    assert not any(result.exposed for result in results)  # before anything is confirmed no one is accused


def test_after_a_new_start_trust_is_to_be_earned_again():
    """Both antennas jump and prevail; then one alone prevails, as at the beginning, before anything is confirmed."""
    screening = Screening(ScreeningSettings(), DEVIATION)
    errors = shift(LATER + 12, LATER, LATER + 6, (3.0, 3.0), (3.0, 3.0))
    restarts = []
    for k, measurement in enumerate(drive(LATER + 12, errors, speed=0.0)):
        tractor, trailer = place(0)
        if k > LATER + 5:  # turned about the tractor's antenna
            trailer = tuple((np.array(tractor) - LENGTH * toward(1.2)).tolist())
        if screening.screen(measurement, (tractor, trailer)).restart:
            restarts.append(k)
    assert restarts == [LATER + 5, LATER + 7, LATER + 9, LATER + 11]


def test_two_false_fixes_do_not_come_back_one_after_the_other_as_the_gates_widen():
    """The trailer's, 30 cm off, would be inside after 2 s; true ones are believed at once, be the other one false."""
    errors = shift(200, LATER, 140, LEFT, -0.3 * LEFT) + shift(200, 140, 160, tractor=LEFT)
    fixes = [result.fixes for result in screened(drive(200, errors, noise=0.01))]
    assert set(fixes[LATER:140]) == {(REJECTED, REJECTED)}
    assert set(fixes[140:160]) == {(REJECTED, OK)}
    assert set(fixes[175:]) == {(OK, OK)}


def test_after_a_loss_the_wide_gate_is_right_for_one_antenna_where_the_other_is_false():
    measurements = drive(200, shift(200, 140, 200, 3.0 * LEFT, -0.3 * LEFT), noise=0.01)
    assert screened(lost(measurements, LATER, 140))[140].fixes == (REJECTED, OK)


def test_an_antenna_at_the_wrong_distance_overrules_nothing():
    assert not any(result.restart for result in screened(drive(20, shift(20, 0, 20, trailer=AHEAD))))
