"""Whether a steering follows its set points: stuck, reversed, or neither."""

import math

import pytest

from drawbar.safety.following import Following
from drawbar.safety.settings import DriveSettings

DEGREE = math.radians(1.0)


def followed(angle_at, set_point_at, seconds=2.0, **settings):
    following = Following(DriveSettings(**settings))
    for tick in range(round(seconds / 0.05) + 1):
        time = 0.05 * tick
        following.add(time, set_point_at(time) * DEGREE, angle_at(time) * DEGREE, time)
    return following


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_steering_that_does_not_move_is_stuck(sign):
    stuck = followed(lambda t: 0.0, lambda t: sign * 3.6)
    assert stuck.stuck
    assert not stuck.reversed
    assert not followed(lambda t: 0.0, lambda t: sign * 3.6, 0.55).stuck, "not yet for long enough"
    assert not followed(lambda t: 0.0, lambda t: sign * 3.4).stuck, "so near it need not move"
    assert not followed(lambda t: sign * 1.0 * t, lambda t: sign * 6.0).stuck, "it moves"
    assert followed(lambda t: sign * 0.7 * t, lambda t: sign * 6.0).stuck


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_stuck_steering_does_not_hide_behind_a_set_point_that_changes_sides(sign):
    assert followed(lambda t: 0.0, lambda t: sign * (6.0 if t % 0.8 < 0.4 else -6.0)).stuck
    assert not followed(lambda t: 0.0, lambda t: sign * (6.0 if t % 0.6 < 0.2 else 1.0)).stuck, "it is seldom far off"
    assert not followed(lambda t: 2.0 * math.sin(8.0 * t), lambda t: sign * (6.0 if t % 0.8 < 0.4 else -6.0)).stuck


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_steering_that_rests_less_far_off_is_stuck_after_longer(sign):
    assert followed(lambda t: 0.04 * math.sin(8.0 * t), lambda t: sign * 2.5, 2.5).stuck
    assert followed(lambda t: 0.0, lambda t: sign * (2.5 if t % 0.8 < 0.4 else -2.5), 2.5).stuck, "it changes sides"
    assert not followed(lambda t: 0.0, lambda t: sign * 2.5, 2.3).stuck, "not yet for long enough"
    assert not followed(lambda t: 0.0, lambda t: sign * 2.2, 9.0).stuck, "a dead band"
    assert not followed(lambda t: round(0.5 * math.sin(t)), lambda t: 0.5 * math.sin(t), 9.0).stuck, "a coarse sensor"

    def moves(t):
        return 0.1 * math.sin(4.0 * t)

    assert not followed(moves, lambda t: sign * 3.0 + moves(t), 9.0).stuck, "it is 3° off, and moves as its set point"


def test_however_long_a_steering_may_take_it_is_seen():
    assert followed(lambda t: 0.0, lambda t: 3.6, 61.0, stuck_time=60.0, stuck_angle=3.5 * DEGREE).stuck


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_steering_that_moves_away_is_reversed(sign):
    assert followed(lambda t: -sign * 12.0 * t, lambda t: sign * 1.5, 0.4).reversed
    assert not followed(lambda t: -sign * 12.0 * t, lambda t: sign * 1.5, 0.25).reversed, "not yet for long enough"
    assert not followed(lambda t: -sign * 12.0 * t, lambda t: sign * 0.9 - sign * 12.0 * t, 0.4).reversed, "it follows"
    assert not followed(lambda t: sign * 12.0 * t, lambda t: sign * 30.0, 1.5).reversed
    assert not followed(lambda t: -sign * 6.0 * t, lambda t: sign * 1.5, 1.5).reversed, "it drifts slowly"
    late = followed(lambda t: -sign * (30.0 * min(t, 0.15) - 2.0 * max(t - 0.15, 0.0)), lambda t: sign * 1.5, 0.4)
    assert not late.reversed, "it has turned round"
    off = followed(lambda t: sign * (3.0 + 12.0 * t), lambda t: sign * 12.0 * t, 1.5)
    assert not off.reversed, "it is 3° off, and moves as its set point does"
    assert not off.stuck


def test_what_was_seen_stays_until_it_is_forgotten():
    following = followed(lambda t: 0.0, lambda t: 5.0)
    following.add(2.05, 0.0, 0.0, 2.05)
    assert following.stuck
    following.reset()
    assert not following.stuck
    following.add(3.0, 5.0 * DEGREE, 0.0, 3.0)
    assert not following.stuck
    turned = followed(lambda t: -12.0 * t, lambda t: 1.5, 0.6)
    assert turned.reversed
    turned.reset()
    assert not turned.reversed


def readings(*angles, every=0.05):
    """Return what a following says of these readings, degrees, each seen at two ticks."""
    following = Following(DriveSettings())
    for i, angle in enumerate(angles):
        for tick in (0.0, 0.02):
            following.add(every * i + tick, 0.0, angle * DEGREE, every * i)
    return following


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_angle_that_leaps_and_stays_has_jumped(sign):
    assert readings(0.0, 0.0, sign * 2.8, sign * 2.7).jumped
    assert readings(0.0, sign * 2.8, sign * 2.8, 0.0, 0.0).jumped
    assert not readings(0.0, 0.0, sign * 2.8).jumped, "it may be a flaw of one reading"
    assert not readings(0.0, sign * 30.0, 0.0, 0.0).jumped, "it was one"
    assert not readings(0.0, sign * 2.7, sign * 2.7).jumped, "so far it may turn"
    assert not readings(0.0, sign * 3.9, sign * 3.9, every=0.1).jumped
    assert readings(0.0, sign * 4.1, sign * 4.1, every=0.1).jumped
    assert not readings(*(sign * 2.7 * i for i in range(20))).jumped, "it turns as fast as that"
    assert not readings(sign * 20.0, sign * 20.0).jumped, "where it begins is no jump"


def test_how_far_an_angle_may_leap_is_set():
    for changes in ({"jump_angle": 2.0 * DEGREE}, {"jump_rate": 35.0 * DEGREE}):
        leap = followed(lambda t: 3.1 if t > 0.975 else 0.0, lambda t: 0.0, 1.1, **changes)
        assert not leap.jumped
    jumped = followed(lambda t: 3.1 if t > 0.975 else 0.0, lambda t: 0.0, 1.1)
    assert jumped.jumped
    jumped.reset()
    jumped.add(2.0, 0.0, 0.0, 2.0)
    jumped.add(2.05, 0.0, 0.0, 2.05)
    assert not jumped.jumped
