"""What receivers do wrong is masked, what they do right is not: on a straight drive with white noise."""

import math
from dataclasses import replace

import numpy as np
import pytest
from screening_alone import (
    AHEAD,
    DEVIATION,
    LATER,
    LEFT,
    MISSING,
    NAMES,
    OK,
    REJECTED,
    STALE,
    Screening,
    drive,
    held,
    lost,
    place,
    screened,
    shift,
    toward,
)

from drawbar.estimation.settings import ScreeningSettings


def test_honest_fixes_pass_as_they_are():
    measurements = drive(1000)
    results = screened(measurements)
    assert [repr(result.measurement) for result in results] == list(map(repr, measurements))  # what is missing is NaN
    assert {result.fixes for result in results} == {(OK, OK)}
    assert not any(result.restart for result in results)


@pytest.mark.parametrize("noise", [0.06, 0.09])
def test_noise_that_is_larger_than_believed_is_found_out_and_passes(noise):
    results = screened(drive(1000, noise=noise))
    wrong = sum(result.fixes != (OK, OK) for result in results)
    assert wrong <= 10
    assert not any(result.restart for result in results[LATER:])


def test_what_is_missing_is_missing_and_a_half_fix_is_none():
    measurements = drive(10)
    measurements[5] = replace(measurements[5], tractor_x=math.nan)
    measurements[6] = replace(measurements[6], trailer_y=math.inf)
    results = screened(measurements)
    assert [result.fixes for result in results[5:7]] == [(MISSING, OK), (OK, MISSING)]
    assert math.isnan(results[5].measurement.tractor_y)
    assert math.isnan(results[6].measurement.trailer_x)
    assert results[5].measurement.trailer_x == measurements[5].trailer_x


@pytest.mark.parametrize(
    ("names", "fixes"), [(NAMES, (STALE, STALE)), (NAMES[:2], (STALE, OK)), (NAMES[2:], (OK, STALE))]
)
def test_a_repeated_fix_is_stale_once_the_vehicle_has_moved(names, fixes):
    results = screened(held(drive(160), 100, 150, names))
    assert {result.fixes for result in results[:100]} == {(OK, OK)}
    assert {result.fixes for result in results[100:150]} == {fixes}
    assert {result.fixes for result in results[150:]} == {(OK, OK)}


def test_a_repeated_fix_is_no_fault_at_rest_nor_is_one_repeated_coordinate():
    at_rest = held(drive(100, speed=0.0), 20, 100)
    assert {result.fixes for result in screened(at_rest, speed=0.0)} == {(OK, OK)}
    measurements = drive(40)
    same_north = [
        replace(m, tractor_y=measurements[19].tractor_y) if k == 20 else m for k, m in enumerate(measurements)
    ]
    assert {result.fixes[0] for result in screened(same_north)} == {OK}


def test_a_stale_fix_stays_stale_when_nothing_comes_between():
    measurements = held(drive(60), 20, 40)
    found = [result.fixes[0] for result in screened(lost(measurements, 30, 33))]
    assert found[20:40] == [STALE] * 10 + [MISSING] * 3 + [STALE] * 7


@pytest.mark.parametrize("antenna", ["tractor", "trailer"])
@pytest.mark.parametrize("direction", np.linspace(0.0, 2.0 * math.pi, 8, endpoint=False))
@pytest.mark.parametrize("size", [0.3, 1.0, 5.0])
def test_a_jump_of_one_antenna_masks_that_antenna_for_as_long_as_it_lasts(antenna, direction, size):
    results = screened(drive(300, shift(300, LATER, 200, **{antenna: size * toward(direction)})))
    one, other = (0, 1) if antenna == "tractor" else (1, 0)
    masked = np.array([result.fixes[one] is REJECTED for result in results])
    assert masked[LATER + 1 : 200].all()
    assert not masked[:LATER].any()
    assert not masked[212:].any()  # its mean needs some samples to forget
    assert {result.fixes[other] for result in results} == {OK}
    assert not any(result.restart for result in results)


def test_a_small_lasting_jump_is_exposed_with_the_samples_before_it():
    results = screened(drive(200, shift(200, LATER, 200, tractor=-0.12 * LEFT)))
    exposed = [k for k, result in enumerate(results) if result.exposed]
    assert len(exposed) == 1
    assert results[exposed[0]].exposed == 1
    assert LATER <= exposed[0] <= LATER + ScreeningSettings().memory


def test_what_moves_both_antennas_accuses_neither():
    blow = -0.065 * LEFT  # until the estimator has followed
    assert {result.fixes for result in screened(drive(200, shift(200, LATER, 104, blow, blow)))} == {(OK, OK)}


@pytest.mark.parametrize(
    ("speed", "fixes"), [(3.0, (OK, OK)), (0.0, (REJECTED, REJECTED)), (math.nan, (REJECTED,) * 2)]
)
def test_both_antennas_may_be_ahead_while_the_wheels_speed_up(speed, fixes):
    count = LATER + 4
    measurements = drive(count, shift(count, LATER, count, 0.6 * AHEAD, 0.6 * AHEAD), noise=0.0)
    shares = np.clip((np.arange(count) - LATER + 3) / 3.0, 0.0, 1.0)  # within three samples: a leap is masked
    speeds = [float(speed * share) if share else 0.0 for share in shares]
    results = screened([replace(m, speed=each) for m, each in zip(measurements, speeds, strict=True)])
    assert {result.fixes for result in results[:LATER]} == {(OK, OK)}
    assert {result.fixes for result in results[LATER:]} == {fixes}


def test_wrong_lengths_are_learned():
    results = screened(drive(600, shift(600, 0, 600, 0.12 * AHEAD, -0.12 * AHEAD)))
    assert sum(result.fixes != (OK, OK) for result in results) <= 6


def far_apart(settings, apart):
    """Return where antennas further apart than expected are believed to be, from their expected places, m."""
    screening, half = Screening(settings, DEVIATION), 0.5 * apart * AHEAD
    errors = shift(LATER, 0, LATER, half, -half)
    seen = [screening.screen(m, place(k), lengths=True) for k, m in enumerate(drive(LATER, errors, noise=0.005))]
    believed = np.array([[getattr(each.measurement, name) for name in NAMES] for each in seen])
    return believed - [np.ravel(place(k)) for k in range(LATER)]


@pytest.mark.parametrize("apart", [0.2, -0.2])
def test_antennas_are_believed_to_be_as_far_apart_as_stated_whatever_their_fixes_say(apart):
    assert np.abs(far_apart(ScreeningSettings(), apart)).max() < 0.03
    untied = far_apart(ScreeningSettings(single_growth=0.1), apart)  # nothing says how far they should be
    assert np.linalg.norm(untied[:, :2] - untied[:, 2:], axis=1) == pytest.approx(abs(apart), abs=0.05)


def test_a_fix_that_stands_alone_is_moved_by_as_much_and_one_that_is_missing_stays_so():
    screening, length = Screening(ScreeningSettings(), DEVIATION), 0.2 * AHEAD
    measurements = drive(LATER, shift(LATER, 0, LATER, tractor=length), noise=0.0)
    measurements[-1] = replace(measurements[-1], trailer_x=math.nan, trailer_y=math.nan)
    seen = [screening.screen(m, place(k), lengths=True) for k, m in enumerate(measurements)][-1]
    place_then = np.array(place(LATER - 1)[0])
    assert [seen.measurement.tractor_x, seen.measurement.tractor_y] == pytest.approx(place_then + 0.5 * length)
    assert math.isnan(seen.measurement.trailer_x + seen.measurement.trailer_y)
    assert seen.fixes == (OK, MISSING)


def test_one_blow_to_an_antenna_is_reported_at_once_and_remembered_for_some_samples():
    for antenna, body in enumerate(("tractor", "trailer")):
        blow = shift(200, LATER, LATER + 1, **{body: 0.15 * LEFT})  # no more than the gate's corner
        results = screened(drive(200, blow, noise=0.0))
        assert [k for k, result in enumerate(results) if result.exposed] == [LATER]
        assert results[LATER].exposed == 1 + antenna
        masked = [k for k, result in enumerate(results) if result.fixes[antenna] is REJECTED]
        assert masked == [*range(LATER, LATER + len(masked))]
        assert 3 <= len(masked) <= 10


def test_the_world_may_turn_and_shift():
    measurements = drive(200, shift(200, LATER, 150, trailer=(0.2, 0.1)))
    one, other = Screening(ScreeningSettings(), DEVIATION), Screening(ScreeningSettings(), DEVIATION)
    c, s = math.cos(2.0), math.sin(2.0)

    def moved(point):
        return c * point[0] - s * point[1] + 70.0, s * point[0] + c * point[1] - 20.0

    for k, m in enumerate(measurements):
        (tx, ty), (ix, iy) = moved((m.tractor_x, m.tractor_y)), moved((m.trailer_x, m.trailer_y))
        turned = replace(m, tractor_x=tx, tractor_y=ty, trailer_x=ix, trailer_y=iy)
        tractor, trailer = place(k)
        assert one.screen(m, (tractor, trailer)).fixes == other.screen(turned, (moved(tractor), moved(trailer))).fixes
