"""What receivers do wrong is masked, what they do right is not: on a straight drive with white noise."""

import math
from dataclasses import replace

import numpy as np
import pytest
from screening_alone import DEVIATION, LENGTH, NAMES, STEP, Screening, drive, held, place, screened, shift

from drawbar.estimation.settings import ScreeningSettings
from drawbar.signals import FixStatus

OK, MISSING, STALE, REJECTED = FixStatus
LATER = 100
"""sample by which the estimate has long been confirmed"""


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
    nothing = dict.fromkeys(NAMES, math.nan)
    measurements[30:33] = [replace(m, **nothing) for m in measurements[30:33]]
    found = [result.fixes[0] for result in screened(measurements)]
    assert found[20:40] == [STALE] * 10 + [MISSING] * 3 + [STALE] * 7


@pytest.mark.parametrize("antenna", [0, 1])
@pytest.mark.parametrize("direction", np.linspace(0.0, 2.0 * math.pi, 8, endpoint=False))
@pytest.mark.parametrize("size", [0.3, 1.0, 5.0])
def test_a_jump_of_one_antenna_masks_that_antenna_for_as_long_as_it_lasts(antenna, direction, size):
    jump = shift(300, LATER, 200, antenna, size * math.cos(direction), size * math.sin(direction))
    results = screened(drive(300, jump))
    masked = np.array([result.fixes[antenna] is REJECTED for result in results])
    assert masked[LATER + 1 : 200].all()
    assert not masked[:LATER].any()
    assert not masked[212:].any()  # its mean needs some samples to forget
    assert {result.fixes[1 - antenna] for result in results} == {OK}
    assert not any(result.restart for result in results)


def test_a_small_lasting_jump_is_exposed_with_the_samples_before_it():
    jump = shift(200, LATER, 200, 0, 0.12 * math.sin(0.4), -0.12 * math.cos(0.4))  # across the vehicle
    results = screened(drive(200, jump))
    exposed = [k for k, result in enumerate(results) if result.exposed]
    assert len(exposed) == 1
    assert results[exposed[0]].exposed == 1
    assert LATER <= exposed[0] <= LATER + ScreeningSettings().memory


def lasting(count, deviation, time, seed, direction=0.4):
    """Return errors (count, 4) of first-order Gauss-Markov noise along the vehicle, or in another direction, m."""
    rng, kept = np.random.default_rng(seed), math.exp(-STEP / time)
    ahead = np.zeros((count, 2))
    ahead[0] = deviation * rng.normal(size=2)
    for k in range(1, count):
        ahead[k] = kept * ahead[k - 1] + deviation * math.sqrt(1.0 - kept**2) * rng.normal(size=2)
    return np.outer(ahead, [math.cos(direction), math.sin(direction)]).reshape(count, 4)


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
        sway = lasting(700, 0.06, 1.0, seed, direction=0.4 + math.pi / 2)
        results = screened(drive(700, sway, seed=seed))[LATER:]
        wrong += [result.fixes != (OK, OK) for result in results]
        deviations += [result.measurement.tractor_fix_deviation for result in results[300:]]
    assert np.mean(wrong) <= 0.01
    kept = math.exp(
        -STEP / 1.0
    )  # many fixes with errors that last so long err like as many independent ones of `alike`
    alike = 0.06 * math.sqrt((1.0 + kept) / (1.0 - kept))
    assert 1.5 * 0.06 < np.mean(deviations) < alike


@pytest.mark.parametrize("missing", [(), ("tractor_roll",), ("trailer_roll",)])
def test_errors_that_last_count_as_sway_only_where_a_roll_is_not_measured(missing):
    measured = {name: 0.0 for name in ("tractor_roll", "trailer_roll") if name not in missing}
    sway = lasting(700, 0.06, 1.0, 0, direction=0.4 + math.pi / 2)
    results = screened([replace(m, **measured) for m in drive(700, sway, seed=0)])
    weighed = np.isfinite([result.measurement.tractor_fix_deviation for result in results[400:]])
    assert set(weighed) == {bool(missing)}
    assert np.mean([result.fixes != (OK, OK) for result in results[LATER:]]) <= 0.01


def exposes(after, *, silent=None):
    """Return whether a shift of 12 cm ahead is found among fixes far better than stated, after so many samples.

    silent: sample in which a receiver says nothing.
    """
    ahead = 0.12 * math.cos(0.4), 0.12 * math.sin(0.4)
    measurements = drive(after + 40, shift(after + 40, after, after + 40, 0, *ahead), noise=0.005)
    if silent is not None:
        measurements[silent] = replace(measurements[silent], tractor_x=math.nan)
    return any(result.exposed for result in screened(measurements))


def test_fixes_without_errors_that_last_are_learned_to_be_so():
    assert [exposes(LATER), exposes(600), exposes(600, silent=590)] == [False, True, True]


@pytest.mark.parametrize("size", [0.3, 1.0, 5.0])
@pytest.mark.parametrize("direction", [0.4, 0.4 + math.pi / 2])
def test_a_jump_among_errors_that_last_is_masked_for_as_long_as_it_lasts(direction, size):
    for seed in range(5):
        jump = shift(300, LATER, 200, 1, size * math.cos(direction), size * math.sin(direction))
        results = screened(drive(300, jump + lasting(300, 0.02, 10.0, seed), noise=0.005, seed=seed))
        masked = np.array([result.fixes[1] is REJECTED for result in results])
        assert masked[LATER + 1 : 200].all()
        assert {result.fixes[0] for result in results} == {OK}


def test_what_moves_both_antennas_accuses_neither():
    errors = np.zeros((200, 4))
    errors[LATER:104] = np.tile([0.025, -0.06], 2)  # a blow to the right, until the estimator has followed
    assert {result.fixes for result in screened(drive(200, errors))} == {(OK, OK)}


FAST = 2.0
"""a yaw rate, rad/s"""


def turned(rates, offsets, settings):
    """Return what becomes of exact fixes whose antennas disagree across by offsets (n,), m; rates (n,) in rad/s."""
    screening = Screening(settings, DEVIATION)
    half = 0.5 * np.outer(offsets, [-math.sin(0.4), math.cos(0.4)])
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


@pytest.mark.parametrize(
    ("speed", "fixes"), [(3.0, (OK, OK)), (0.0, (REJECTED, REJECTED)), (math.nan, (REJECTED,) * 2)]
)
def test_both_antennas_may_be_ahead_while_the_wheels_speed_up(speed, fixes):
    ahead = 0.6 * np.array([math.cos(0.4), math.sin(0.4)])
    measurements = drive(
        LATER + 4, np.tile(ahead, (LATER + 4, 2)) * (np.arange(LATER + 4) >= LATER)[:, None], noise=0.0
    )
    shares = np.clip((np.arange(LATER + 4) - LATER + 3) / 3.0, 0.0, 1.0)  # within three samples: a leap is masked
    sped = [
        replace(m, speed=float(speed * share) if share else 0.0) for m, share in zip(measurements, shares, strict=True)
    ]
    results = screened(sped)
    assert {result.fixes for result in results[:LATER]} == {(OK, OK)}
    assert {result.fixes for result in results[LATER:]} == {fixes}


@pytest.mark.parametrize(
    ("name", "false"), [("speed", 9.0), ("speed", -9.0), ("tractor_steering", 1.4), ("trailer_steering", -0.5)]
)
def test_a_single_value_that_leaps_is_masked_and_two_are_believed(name, false):
    usual = getattr(drive(1)[0], name)
    told = [usual] * 10 + [false] + [usual] * 5 + [false] * 5 + [math.nan] + [usual] * 3
    measurements = [replace(m, **{name: value}) for m, value in zip(drive(len(told)), told, strict=True)]
    seen = [getattr(result.measurement, name) for result in screened(measurements)]
    masked = [k for k, value in enumerate(seen) if math.isnan(value)]
    assert masked == [10, 16, 21, 22]  # alone; the first of some; missing; the first of those that come back
    assert all(value == told[k] for k, value in enumerate(seen) if k not in masked)


def test_steering_and_speed_that_change_as_fast_as_machines_do_pass():
    rng = np.random.default_rng(5)
    rates = np.clip(np.cumsum(rng.normal(0.0, 0.2, 400)), -1.0, 1.0)  # 57°/s and 4 m/s² at most
    measurements = [
        replace(m, tractor_steering=0.19 * rate, trailer_steering=-0.19 * rate, speed=2.0 + 0.8 * rate)
        for m, rate in zip(drive(400), np.where(np.arange(400) % 2, rates, 0.0).tolist(), strict=True)
    ]
    assert all(
        math.isfinite(r.measurement.speed + r.measurement.tractor_steering + r.measurement.trailer_steering)
        for r in screened(measurements)
    )


def test_wrong_lengths_are_learned():
    along = 0.12 * np.array([math.cos(0.4), math.sin(0.4)])
    results = screened(drive(600, np.tile([*along, *-along], (600, 1))))
    assert sum(result.fixes != (OK, OK) for result in results) <= 6


def far_apart(settings, apart):
    """Return where antennas further apart than expected are believed to be, from their expected places, m."""
    screening, half = Screening(settings, DEVIATION), 0.5 * apart * np.array([math.cos(0.4), math.sin(0.4)])
    errors = np.tile([*half, *-half], (LATER, 1))
    seen = [screening.screen(m, place(k), lengths=True) for k, m in enumerate(drive(LATER, errors, noise=0.005))]
    believed = np.array([[getattr(each.measurement, name) for name in NAMES] for each in seen])
    return believed - [np.ravel(place(k)) for k in range(LATER)]


@pytest.mark.parametrize("apart", [0.2, -0.2])
def test_antennas_are_believed_to_be_as_far_apart_as_stated_whatever_their_fixes_say(apart):
    assert np.abs(far_apart(ScreeningSettings(), apart)).max() < 0.03
    untied = far_apart(ScreeningSettings(single_growth=0.1), apart)  # nothing says how far they should be
    assert np.linalg.norm(untied[:, :2] - untied[:, 2:], axis=1) == pytest.approx(abs(apart), abs=0.05)


def test_a_fix_that_stands_alone_is_moved_by_as_much_and_one_that_is_missing_stays_so():
    screening, length = Screening(ScreeningSettings(), DEVIATION), 0.2 * np.array([math.cos(0.4), math.sin(0.4)])
    measurements = drive(LATER, np.tile([*length, 0.0, 0.0], (LATER, 1)), noise=0.0)
    measurements[-1] = replace(measurements[-1], trailer_x=math.nan, trailer_y=math.nan)
    seen = [screening.screen(m, place(k), lengths=True) for k, m in enumerate(measurements)][-1]
    place_then = np.array(place(LATER - 1)[0])
    assert [seen.measurement.tractor_x, seen.measurement.tractor_y] == pytest.approx(place_then + 0.5 * length)
    assert math.isnan(seen.measurement.trailer_x + seen.measurement.trailer_y)
    assert seen.fixes == (OK, MISSING)


def test_after_a_loss_the_gate_is_as_wide_as_dead_reckoning_is_wrong():
    """Ten seconds without a fix make room for one metre more."""
    for offset, accepted in ((0.8, True), (1.5, False)):
        errors = np.tile([0.0, offset], (200, 2))
        measurements = drive(200, errors * (np.arange(200) >= 150)[:, None])
        nothing = dict.fromkeys(NAMES, math.nan)
        measurements[100:150] = [replace(m, **nothing) for m in measurements[100:150]]
        assert (screened(measurements)[150].fixes == (OK, OK)) is accepted


def test_two_antennas_that_agree_with_each_other_prevail():
    errors = np.zeros((200, 4))
    errors[LATER:] = 3.0
    results = screened(drive(200, errors))
    restarts = [k for k, result in enumerate(results) if result.restart]
    patience = round(ScreeningSettings().patience / STEP)
    assert restarts[0] == LATER + patience
    assert results[restarts[0]].fixes == (OK, OK)
    assert np.diff(restarts).tolist() == [2] * (len(restarts) - 1)  # nothing follows them here, and trust is gone
    assert {result.fixes for result in results[LATER : restarts[0]]} == {(REJECTED, REJECTED)}


@pytest.mark.parametrize("error", [0.4, -1.0])
def test_two_antennas_that_turn_the_vehicle_about_do_not_prevail_before_dead_reckoning_may_have_turned_as_much(error):
    """Both are as far from each other as they should be, and metres off, as false fixes may be."""
    ahead = np.array([math.cos(0.4), math.sin(0.4)])
    turned = np.array([math.cos(0.4 + error), math.sin(0.4 + error)])
    errors = np.zeros((600, 4))
    errors[LATER:] = [3.0, 3.0, *(3.0 + LENGTH * (ahead - turned))]
    restarts = [k for k, result in enumerate(screened(drive(600, errors))) if result.restart]
    settings = ScreeningSettings()
    room = LENGTH * abs(math.sin(error)) - settings.length - settings.lateral * DEVIATION
    assert restarts[0] == pytest.approx(LATER + (room / settings.growth + settings.patience) / STEP, abs=5)
    assert restarts[0] > LATER + 4 * settings.patience / STEP


def test_two_antennas_that_contradict_each_other_do_not_prevail():
    errors = np.zeros((200, 4))
    errors[LATER:, 0], errors[LATER:, 3] = 30.0, -20.0
    results = screened(drive(200, errors))
    assert not any(result.restart for result in results)
    assert {result.fixes for result in results[LATER:]} == {(REJECTED, REJECTED)}


@pytest.mark.parametrize("error", [0.3, math.pi / 4, math.pi / 2, math.pi, -math.pi / 2])
def test_a_yaw_that_was_wrong_from_the_start_is_overruled_by_one_antenna(error):
    screening = Screening(ScreeningSettings(), DEVIATION)
    tractor = np.array(place(0)[0])
    trailer = tractor - LENGTH * np.array([math.cos(0.4 + error), math.sin(0.4 + error)])
    expected = (tuple(tractor.tolist()), tuple(trailer.tolist()))
    results = [screening.screen(measurement, expected) for measurement in drive(6, speed=0.0)]
    assert [result.restart for result in results] == [False, True] * 3  # nothing follows it here: once more
    assert not any(result.exposed for result in results)  # before anything is confirmed no one is accused


def test_one_blow_to_an_antenna_is_reported_at_once_and_remembered_for_some_samples():
    across = np.array([-math.sin(0.4), math.cos(0.4)])
    for antenna in (0, 1):
        blow = shift(200, LATER, LATER + 1, antenna, *(0.15 * across))  # no more than the gate's corner
        results = screened(drive(200, blow, noise=0.0))
        assert [k for k, result in enumerate(results) if result.exposed] == [LATER]
        assert results[LATER].exposed == 1 + antenna
        masked = [k for k, result in enumerate(results) if result.fixes[antenna] is REJECTED]
        assert masked == [*range(LATER, LATER + len(masked))]
        assert 3 <= len(masked) <= 10


def test_after_a_new_start_trust_is_to_be_earned_again():
    """Both antennas jump and prevail; then one alone prevails, as at the beginning, before anything is confirmed."""
    screening = Screening(ScreeningSettings(), DEVIATION)
    errors = np.zeros((LATER + 12, 4))
    errors[LATER : LATER + 6] = 3.0
    restarts = []
    for k, measurement in enumerate(drive(LATER + 12, errors, speed=0.0)):
        tractor, trailer = place(0)
        if k > LATER + 5:  # turned about the tractor's antenna
            trailer = tuple((np.array(tractor) - LENGTH * np.array([math.cos(1.2), math.sin(1.2)])).tolist())
        if screening.screen(measurement, (tractor, trailer)).restart:
            restarts.append(k)
    assert restarts == [LATER + 5, LATER + 7, LATER + 9, LATER + 11]


def across(tractor, trailer):
    """Return what shifts both antennas to the left, m."""
    return np.array(
        [-tractor * math.sin(0.4), tractor * math.cos(0.4), -trailer * math.sin(0.4), trailer * math.cos(0.4)]
    )


def test_two_false_fixes_do_not_come_back_one_after_the_other_as_the_gates_widen():
    """The trailer's, 30 cm off, would be inside after 2 s; true ones are believed at once, be the other one false."""
    errors = np.zeros((200, 4))
    errors[LATER:140], errors[140:160] = across(1.0, -0.3), across(1.0, 0.0)
    fixes = [result.fixes for result in screened(drive(200, errors, noise=0.01))]
    assert set(fixes[LATER:140]) == {(REJECTED, REJECTED)}
    assert set(fixes[140:160]) == {(REJECTED, OK)}
    assert set(fixes[175:]) == {(OK, OK)}


def test_after_a_loss_the_wide_gate_is_right_for_one_antenna_where_the_other_is_false():
    nothing = dict.fromkeys(NAMES, math.nan)
    measurements = drive(200, np.tile(across(3.0, -0.3), (200, 1)) * (np.arange(200) >= 140)[:, None], noise=0.01)
    measurements[LATER:140] = [replace(m, **nothing) for m in measurements[LATER:140]]
    assert screened(measurements)[140].fixes == (REJECTED, OK)


def test_an_antenna_at_the_wrong_distance_overrules_nothing():
    errors = shift(20, 0, 20, 1, 1.0 * math.cos(0.4), 1.0 * math.sin(0.4))
    assert not any(result.restart for result in screened(drive(20, errors)))


def test_the_world_may_turn_and_shift():
    jump = shift(200, LATER, 150, 1, 0.2, 0.1)
    measurements = drive(200, jump)
    one, other = Screening(ScreeningSettings(), DEVIATION), Screening(ScreeningSettings(), DEVIATION)
    c, s = math.cos(2.0), math.sin(2.0)

    def moved(point):
        return c * point[0] - s * point[1] + 70.0, s * point[0] + c * point[1] - 20.0

    for k, m in enumerate(measurements):
        (tx, ty), (ix, iy) = moved((m.tractor_x, m.tractor_y)), moved((m.trailer_x, m.trailer_y))
        turned = replace(m, tractor_x=tx, tractor_y=ty, trailer_x=ix, trailer_y=iy)
        tractor, trailer = place(k)
        assert one.screen(m, (tractor, trailer)).fixes == other.screen(turned, (moved(tractor), moved(trailer))).fixes
