"""Position drift: positions of the antennas are held against the velocities that their receivers report."""

import math

import numpy as np
import pytest
from fixes import altered, fixes_of

from drawbar.driving.fault_detection.position_drift import PositionDrift
from drawbar.signals import FixQuality, Measurement

PERIOD = 0.2
UNUSED = ("tractor_x", "tractor_y", "trailer_x", "trailer_y", "hitch_angle", "speed", "tractor_steering")
UNUSED += ("trailer_steering",)


def epoch(time, *, speed=2.0, radius=math.inf, noise=(0.0,) * 4, aside=(0.0, 0.0), told=1.0, lag=0.0, **given):
    """Return what both receivers say at a time (s) on a line or circle; aside in m to the left of the start."""
    turned = speed * time / radius
    x = radius * math.sin(turned) if turned else speed * time
    y = radius * (1.0 - math.cos(turned)) if turned else 0.0
    values = {"epoch": round((1.0 + time) * 1e9)}
    for i, body in enumerate(("tractor", "trailer")):
        values |= {
            f"{body}_x": x + noise[2 * i],
            f"{body}_y": y + noise[2 * i + 1] + aside[i],
            f"{body}_speed": told * speed,
            f"{body}_course": turned - speed * lag / radius,
            f"{body}_quality": int(FixQuality.FIXED),
        }
    return fixes_of(**(values | given))


def heard(drift, times, **given):
    """Return when a drift was first seen, s; None: never."""
    for time in times:
        drift.receive_fixes(epoch(time, **given))
        if drift.is_detected:
            return time
    return None


def times(end, begin=0.0):
    return np.arange(begin, end, PERIOD).tolist()


@pytest.mark.parametrize("radius", [math.inf, 8.0, -8.0, 3.4])
@pytest.mark.parametrize("speed", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("lag", [0.0, 0.15])
def test_ordinary_noise_is_no_drift(radius, speed, lag):
    drift, rng = PositionDrift(), np.random.default_rng(1)
    for time in times(600.0):
        drift.receive_fixes(epoch(time, speed=speed, radius=radius, lag=lag, noise=tuple(rng.normal(0.0, 0.03, 4))))
        assert not drift.is_detected, time


@pytest.mark.parametrize(("speed", "latest"), [(1.0, 0.9), (2.0, 0.9), (3.0, 1.1)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_both_antennas_that_drift_are_seen_and_one_alone_is_not(speed, latest, side):
    for both in (True, False):
        drift, begin = PositionDrift(), 5.0
        assert heard(drift, times(begin), speed=speed) is None
        found = None
        for time in times(20.0, begin):
            off = 0.3 * side * (time - begin)
            drift.receive_fixes(epoch(time, speed=speed, aside=(off, off if both else 0.0)))
            found = time if drift.is_detected and found is None else found
        assert (found is not None) == both
        assert found is None or 0.6 < found - begin <= latest


def test_antennas_that_go_to_different_sides_do_not_drift_together():
    drift, begin = PositionDrift(), 5.0
    assert heard(drift, times(begin)) is None
    for time in times(8.0, begin):
        drift.receive_fixes(epoch(time, aside=(0.3 * (time - begin), -0.3 * (time - begin))))
        assert not drift.is_detected


@pytest.mark.parametrize(
    ("aside", "seen"),
    [((0.14, 0.14), False), ((0.16, 0.16), True), ((0.21, 0.11), True), ((0.30, 0.09), False), ((0.45, -0.12), False)],
)
def test_the_mean_of_both_decides_where_each_is_aside(aside, seen):
    drift = PositionDrift()
    assert heard(drift, times(5.0)) is None
    assert (heard(drift, times(6.0, 5.0), aside=aside) is not None) is seen


@pytest.mark.parametrize("unknown", [{"trailer_quality": int(FixQuality.FLOAT)}, {"trailer_x": math.nan}])
@pytest.mark.parametrize(("aside", "seen"), [(0.2, False), (0.22, True)])
def test_where_one_antenna_is_not_known_the_other_decides_alone(unknown, aside, seen):
    drift = PositionDrift()
    assert heard(drift, times(5.0), **unknown) is None
    assert (heard(drift, times(6.0, 5.0), aside=(aside, aside), **unknown) is not None) is seen


def drift_in_curve(radius, lag, side, *, learned):
    """Return after which time a drift in a curve is seen, s, where the lag of the course has been learned, or not."""
    drift, begin = PositionDrift(), 25.2 if learned else 2.4  # after a whole circle
    assert heard(drift, times(begin), radius=radius, lag=lag) is None
    for time in times(begin + 4.0, begin):
        off = 0.3 * side * (time - begin)
        drift.receive_fixes(epoch(time, radius=radius, lag=lag, aside=(off, off)))
        if drift.is_detected:
            return time - begin
    return math.inf


@pytest.mark.parametrize("radius", [8.0, -8.0])
def test_in_a_curve_a_drift_is_seen_as_soon_once_the_lag_is_known(radius):
    inside = math.copysign(1.0, radius)
    assert drift_in_curve(radius, 0.0, inside, learned=True) <= 0.9
    assert drift_in_curve(radius, 0.0, inside, learned=False) > 0.9
    assert drift_in_curve(radius, 0.0, -inside, learned=False) <= 0.9
    assert drift_in_curve(radius, 0.15, inside, learned=True) <= 0.9


def test_a_drift_is_not_learned_as_a_lag_before_it_is_seen():
    drift = PositionDrift()
    assert heard(drift, times(12.0), radius=8.0) is None
    before = drift._tractor._lag.largest
    for time in times(14.0, 12.0):
        aside = -0.3 * (time - 12.0)  # after half a circle: to the left
        drift.receive_fixes(epoch(time, radius=8.0, aside=(aside, aside)))
    assert drift.is_detected
    assert drift._tractor._lag.largest <= before


def jumped(drift, when, **given):
    drift.receive_fixes(epoch(when, **given))
    return drift.has_jumped


def test_both_antennas_that_jump_and_stay_there_are_reported():
    drift = PositionDrift()
    assert heard(drift, times(5.0)) is None
    assert not jumped(drift, 5.0, aside=(1.0, 1.0))
    assert all(jumped(drift, when, aside=(1.0, 1.0)) for when in times(5.9, 5.2))
    assert not any(jumped(drift, when, aside=(1.0, 1.0)) for when in times(7.0, 6.2))


def test_one_false_epoch_is_no_jump_and_neither_is_one_antenna_or_a_gap():
    drift = PositionDrift()
    assert heard(drift, times(5.0)) is None
    assert not jumped(drift, 5.0, aside=(1.0, 1.0))
    assert not any(jumped(drift, when) for when in times(8.0, 5.2))
    assert not any(jumped(drift, when, aside=(1.0, 0.0)) for when in times(11.0, 8.0))
    assert not any(jumped(drift, when, aside=(3.0, 3.0)) for when in times(14.0, 11.6))


def test_positions_fit_the_velocities_where_they_neither_drift_nor_jump_and_are_known():
    drift = PositionDrift()
    assert heard(drift, times(1.0)) is None
    assert not drift.tractor_fits, "too little is known"
    assert heard(drift, times(5.0, 1.0)) is None
    assert drift.tractor_fits
    for time in times(6.4, 5.0):
        drift.receive_fixes(epoch(time, aside=(0.3 * (time - 5.0), 0.0)))
    assert not drift.tractor_fits
    jumped, drift = PositionDrift(), PositionDrift()
    heard(jumped, times(5.0))
    heard(jumped, times(6.0, 5.0), aside=(1.0, 0.0))
    assert not jumped.tractor_fits
    heard(drift, times(5.0))
    drift.receive_fixes(epoch(5.0, tractor_quality=int(FixQuality.FLOAT)))
    assert not drift.tractor_fits


def test_the_only_antenna_that_is_known_jumps_alone():
    drift = PositionDrift()
    assert heard(drift, times(5.0), trailer_x=math.nan) is None
    assert [jumped(drift, when, aside=(1.0, 1.0), trailer_x=math.nan) for when in (5.0, 5.2)] == [False, True]


def test_a_velocity_whose_direction_lags_by_far_is_a_contradiction():
    assert heard(PositionDrift(), times(10.0), speed=2.0, radius=8.0, lag=0.1) is None
    assert heard(PositionDrift(), times(10.0), speed=2.0, radius=8.0, lag=0.6) is not None


def test_a_jump_is_seen_only_if_it_stays():
    drift = PositionDrift()
    assert heard(drift, times(5.0)) is None
    drift.receive_fixes(epoch(5.0, aside=(0.4, 0.4)))
    assert heard(drift, times(12.0, 5.2)) is None
    assert heard(drift, times(14.0, 12.0), aside=(0.4, 0.4)) == pytest.approx(12.2)


def test_one_that_the_estimator_rejects_is_no_drift():
    """Both receivers change places in a curve, which looks as if they went aside."""
    drift = PositionDrift()
    assert heard(drift, times(5.0), radius=8.0) is None
    assert heard(drift, times(10.0, 5.0), radius=8.0, aside=(1.0, 1.0)) is None


def test_a_speed_in_a_wrong_unit_is_no_drift():
    assert heard(PositionDrift(), times(20.0), told=1.94) is None


@pytest.mark.parametrize("field", ["quality", "course", "x"])
def test_without_fixed_positions_and_velocities_nothing_is_said(field):
    value = int(FixQuality.FLOAT) if field == "quality" else math.nan
    given = {f"{body}_{field}": value for body in ("tractor", "trailer")}
    drift = PositionDrift()
    for time in times(20.0):
        drift.receive_fixes(epoch(time, aside=(0.3 * time, 0.3 * time), **given))
        assert not drift.is_detected


def test_after_a_gap_it_begins_anew():
    drift = PositionDrift()
    assert heard(drift, times(5.0)) is None
    assert heard(drift, times(12.0, 6.0), aside=(1.0, 1.0)) is None
    assert heard(PositionDrift(), times(20.0), speed=0.1) is None


def found_with_a_gap(gap, **missing):
    """Return when a drift of 0.05 m/s is seen that begins at 10 s, where epochs of a time lack something, or all."""
    drift, begin = PositionDrift(), 10.0
    for time in times(25.0):
        off = max(0.05 * (time - begin), 0.0)
        lacks = gap[0] <= time < gap[1]
        if not lacks or missing:
            drift.receive_fixes(epoch(time, aside=(off, off), **(missing if lacks else {})))
        if drift.drifts_slowly(**FOLLOWED):
            return time - begin
    return math.inf


def test_lost_epochs_hide_no_slow_drift_for_long():
    never = (math.inf, math.inf)
    assert found_with_a_gap(never) < 4.7
    assert found_with_a_gap((13.5, 14.5)) < 7.5
    both_float = {f"{body}_quality": int(FixQuality.FLOAT) for body in ("tractor", "trailer")}
    assert found_with_a_gap((13.5, 15.5), **both_float) <= 7.0
    assert found_with_a_gap((13.5, 17.5), **both_float) > 11.0, "after so long it begins anew"
    assert found_with_a_gap((13.5, 15.5)) > 9.0, "velocities of so long ago say nothing"


@pytest.mark.parametrize("speed", [1.0, 2.0, 3.0])
def test_a_turn_that_begins_while_epochs_are_lost_is_no_drift(speed):
    drift, begin, rate, x, y, course = PositionDrift(), 10.0, 0.0, 0.0, 0.0, 0.0
    for time in np.arange(0.0, 25.0, 0.01):
        if begin <= time < begin + 1.0:
            rate += 0.01 * math.radians(20.0) * speed / 1.4
        course += 0.01 * rate
        x, y = x + 0.01 * speed * math.cos(course), y + 0.01 * speed * math.sin(course)
        if round(100 * time) % 20 or begin <= time < begin + 1.0:
            continue
        place = {"x": x, "y": y, "course": course, "speed": speed}
        given = {f"{body}_{name}": value for body in ("tractor", "trailer") for name, value in place.items()}
        drift.receive_fixes(epoch(time, **given))
        assert not drift.is_detected
        assert not drift.drifts_slowly(**FOLLOWED)


def test_from_where_they_were_before_the_velocities_lead_on():
    drift, begin = PositionDrift(), 5.0
    assert heard(drift, times(begin), radius=20.0) is None
    for time in times(8.0, begin):
        off = 0.3 * (time - begin)
        drift.receive_fixes(epoch(time, radius=20.0, aside=(off, off)))
        if drift.is_detected and time < 6.1:
            drift.begin_dead_reckoning()
    measured = Measurement(time=0.0, **dict.fromkeys(UNUSED, 0.0))
    true = epoch(times(8.0)[-1], radius=20.0)
    carried = drift.dead_reckoned(measured)
    found = (carried.tractor_x, carried.tractor_y, carried.trailer_x, carried.trailer_y)
    assert found == pytest.approx((true.tractor.x, true.tractor.y, true.trailer.x, true.trailer.y), abs=0.01)
    drift.receive_fixes(epoch(9.0))
    assert math.isnan(drift.dead_reckoned(measured).tractor_x), "an epoch was lost"


FOLLOWED = {"tractor": True, "trailer": True}


def slowly(rates, *, speed=2.0, begin=12.0, **followed):
    """Return after which time a slow drift of both antennas (m/s each) is seen, s; infinite: within 20 s it is not."""
    drift = PositionDrift()
    for time in times(begin + 20.0):
        since = max(time - begin, 0.0)
        aside = (rates[0] * since, rates[1] * since)
        drift.receive_fixes(epoch(time, speed=speed, aside=aside))
        if drift.drifts_slowly(**(FOLLOWED | followed)):
            return time - begin
    return math.inf


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_slow_drift_of_both_antennas_is_seen_within_five_seconds(speed, side):
    assert 3.5 < slowly((0.05 * side, 0.05 * side), speed=speed) <= 5.0
    assert slowly((0.02 * side, 0.02 * side), speed=speed) == math.inf


@pytest.mark.parametrize("rates", [(0.05, 0.0), (0.0, 0.05)])
def test_an_antenna_that_drifts_slowly_alone_is_seen_unless_the_estimate_rejects_it(rates):
    drifting, right = ("tractor", "trailer") if rates[0] else ("trailer", "tractor")
    alone = slowly(rates)
    assert 5.5 < alone <= 7.0
    assert slowly(rates, **{drifting: False}) == math.inf
    assert slowly(rates, **{right: False}) <= alone - 1.0, "the estimate follows the one that drifts"
    apart = 1.1 if rates[0] else -1.1
    assert 3.5 < slowly(rates, apart=apart) <= alone - 1.5
    assert slowly(rates, apart=-apart) == alone, "they are apart the other way"
    assert slowly(rates, apart=0.9 * apart) == alone
    assert slowly(rates, apart=apart, **{drifting: False}) == math.inf
    assert slowly(rates, **{drifting: False, right: False}) == math.inf


def test_noise_of_positions_and_velocities_is_no_slow_drift():
    rng, kept = np.random.default_rng(2), math.exp(-PERIOD / 0.3)
    drift, velocity = PositionDrift(), np.zeros(2)
    for time in times(3600.0):
        velocity = kept * velocity + math.sqrt(1.0 - kept**2) * rng.normal(0.0, 0.03, 2)
        heard_now = epoch(time, noise=tuple(rng.normal(0.0, 0.02, 4)))
        courses = {f"{body}_course": velocity[i] / 2.0 for i, body in enumerate(("tractor", "trailer"))}
        drift.receive_fixes(altered(heard_now, **courses))
        assert not drift.drifts_slowly(**FOLLOWED), time


def test_after_a_slow_drift_the_velocities_lead_from_where_it_had_hardly_begun():
    drift, begin = PositionDrift(), 12.0
    for time in times(40.0):
        off = 0.05 * max(time - begin, 0.0)
        drift.receive_fixes(epoch(time, aside=(off, off)))
        if drift.drifts_slowly(**FOLLOWED):
            break
    drift.begin_dead_reckoning()
    led = drift.dead_reckoned(Measurement(time=0.0, **dict.fromkeys(UNUSED, 0.0)))
    assert (led.tractor_y, led.trailer_y) == pytest.approx((0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_in_a_curve_a_slow_drift_to_the_inside_is_not_learned_as_lag(side):
    drift, begin, radius, found = PositionDrift(), 14.0, 8.0 * side, math.inf
    for time in times(begin + 12.0):
        off, turned = 0.05 * max(time - begin, 0.0), 2.0 * time / radius
        inside = (-off * side * math.sin(turned), off * side * math.cos(turned))
        drift.receive_fixes(epoch(time, radius=radius, noise=inside * 2))
        found = min(found, time - begin) if drift.drifts_slowly(**FOLLOWED) else found
    assert 4.0 < found <= 5.0


LAGS = {"speed": 2.0, "radius": 8.0}


def apart_in_curve(rate, lags, apart):
    """Return after which time a slow drift of the tractor's antenna (m/s) to the inside of a first curve is seen, s."""
    drift = PositionDrift()
    for time in times(24.0, -12.0):
        where = epoch(time, **(LAGS if time >= 0.0 else {"speed": 2.0}))
        off, turned = rate * max(time - 2.0, 0.0), max(time, 0.0) * 0.25
        aside = {
            "tractor_x": where.tractor.x - off * math.sin(turned),
            "tractor_y": where.tractor.y + off * math.cos(turned),
        }
        courses = {
            f"{body}_course": 0.25 * max(time - lag, 0.0)
            for body, lag in zip(("tractor", "trailer"), lags, strict=True)
        }
        drift.receive_fixes(altered(where, **aside, **courses))
        if drift.drifts_slowly(apart=apart, **FOLLOWED):
            return time - 2.0
    return math.inf


def test_of_one_antenna_it_is_seen_in_a_first_curve_by_what_it_is_aside_more_than_the_other():
    assert apart_in_curve(0.05, (0.0, 0.0), 1.1) <= 5.0
    assert apart_in_curve(0.05, (0.1, 0.1), 1.1) <= 5.0, "both lag"
    assert apart_in_curve(0.05, (0.0, 0.0), 0.0) > 6.0
    assert apart_in_curve(0.0, (0.25, 0.25), 1.1) == math.inf
    assert apart_in_curve(0.0, (0.25, 0.0), 0.0) == math.inf, "one receiver's velocity lags, the antennas are not apart"


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_speeds_that_come_in_knots_in_a_curve_are_no_slow_drift(side):
    drift = PositionDrift()
    for time in times(40.0):
        drift.receive_fixes(epoch(time, radius=8.0 * side, told=1.0 if time < 20.0 else 3600.0 / 1852.0))
        assert not drift.drifts_slowly(**FOLLOWED), time


@pytest.mark.parametrize(("speed", "radius"), [(1.0, 8.0), (2.0, -8.0), (3.0, 16.0)])
def test_a_course_that_lags_behind_a_curve_is_no_slow_drift(speed, radius):
    drift = PositionDrift()
    for time in times(60.0):
        straight = time < 20.0
        drift.receive_fixes(epoch(time - 20.0, speed=speed, radius=math.inf if straight else radius, lag=0.25))
        assert not drift.is_detected, time
        assert not drift.drifts_slowly(**FOLLOWED), time
