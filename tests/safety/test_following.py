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

    def slightly(t):
        return 0.1 * math.sin(8.0 * t)

    assert not followed(slightly, lambda t: sign * (6.0 if t % 0.6 < 0.2 else 1.0)).stuck, "it is seldom far off"
    assert not followed(lambda t: 2.0 * math.sin(8.0 * t), lambda t: sign * (6.0 if t % 0.8 < 0.4 else -6.0)).stuck


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_steering_that_rests_after_its_set_point_was_far_off_is_stuck(sign):
    def asked(t):
        return sign * (3.6 if 1.0 <= t < 1.22 else 0.5)

    assert followed(lambda t: 0.04 * math.sin(8.0 * t), asked, 1.7).stuck
    assert not followed(lambda t: 0.0, asked, 1.55).stuck, "it may have dead time"
    assert not followed(lambda t: 0.0, lambda t: asked(t) * 3.4 / 3.6, 1.9).stuck, "so near it need not move"
    late = followed(lambda t: sign * 5.0 * min(max(t - 1.5, 0.0), 0.2), asked, 3.0)
    assert not late.stuck, "0.5 s of dead time, then it moves at 5°/s"


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


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_steering_that_swings_and_does_not_come_nearer_is_stuck(sign):
    assert followed(lambda t: math.sin(8.0 * t), lambda t: sign * 8.0).stuck
    assert not followed(lambda t: math.sin(8.0 * t), lambda t: sign * 4.0).stuck, "at times it need not move"


def test_it_keeps_no_more_than_it_judges():
    following = followed(lambda t: t, lambda t: t, 60.0)
    assert len(following._samples) == 50, "2.4 s, and one before"


def test_however_long_a_steering_may_take_it_is_seen():
    assert followed(lambda t: 0.0, lambda t: 3.6, 61.0, stuck_time=60.0, stuck_angle=3.5 * DEGREE).stuck


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_steering_that_moves_away_is_reversed(sign):
    assert followed(lambda t: -sign * 12.0 * t, lambda t: sign * 1.5, 0.4).reversed
    assert not followed(lambda t: -sign * 12.0 * t, lambda t: sign * 1.5, 0.25).reversed, "not yet for long enough"
    assert not followed(lambda t: -sign * 12.0 * t, lambda t: sign * 0.9 - sign * 12.0 * t, 0.4).reversed, "it follows"
    assert followed(lambda t: -sign * 12.0 * t, lambda t: sign * 1.1, 0.35).reversed, "1.7° off is on one side"
    assert not followed(lambda t: sign * 12.0 * t, lambda t: sign * 30.0, 1.5).reversed
    assert not followed(lambda t: -sign * 6.0 * t, lambda t: sign * 1.5, 1.5).reversed, "it drifts slowly"
    late = followed(lambda t: -sign * (30.0 * min(t, 0.15) - 2.0 * max(t - 0.15, 0.0)), lambda t: sign * 1.5, 0.4)
    assert not late.reversed, "it has turned round"
    off = followed(lambda t: sign * (3.0 + 12.0 * t), lambda t: sign * 12.0 * t, 1.5)
    assert not off.reversed, "it is 3° off, and moves as its set point does"
    assert not off.stuck


def stands_off(off, slow=lambda t: 0.0):
    """Return what is said of a steering that is so far (degrees) off the set point that it follows, then rests.

    It moves away from straight by 2° within 1 s, then back, and rests there; its set point goes on by `slow`.
    """

    def angle(t):
        return math.copysign(max(2.0 - 2.0 * abs(t - 1.0), 0.0), off)

    return followed(lambda t: angle(t) + off, lambda t: angle(t) - slow(max(t - 2.0, 0.0)), 6.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_steering_that_has_followed_while_it_stood_off_may_be_further_off_by_that(sign):
    def further(by):
        return lambda t: sign * by * min(t, 1.0)

    assert not stands_off(sign * 2.3, further(2.2)).stuck, "2.3° off, then 2.2 further, which is not 2.33"
    assert stands_off(sign * 2.3, further(2.4)).stuck
    assert stands_off(sign * 1.2, further(2.4)).stuck
    assert not stands_off(sign * 1.2, further(2.2)).stuck
    assert stands_off(sign * 3.0, further(1.7)).stuck, "no more than 2.33° is forgiven"
    assert not stands_off(sign * 3.0, further(1.6)).stuck

    def rests(t):
        return sign * (3.0 if t > 0.5 else 0.0)

    assert followed(lambda t: 0.0, rests, 3.2).stuck, "it has gone nowhere: nothing is forgiven"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_steering_that_stands_off_and_is_stuck_far_off_is_seen_as_soon(sign):
    def angle(t):
        return sign * (3.0 + min(t, 1.0))

    def stuck(gap, seconds):
        return followed(angle, lambda t: sign * (min(t, 1.0) - (gap - 3.0 if t > 1.0 else 0.0)), seconds).stuck

    assert stuck(5.9, 1.7)
    assert not stuck(5.9, 1.5), "not yet for long enough"
    assert not stuck(5.8, 3.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_steering_that_follows_is_forgiven_nothing(sign):
    def stuck(angle, set_point, until, gap=3.6):
        """Return whether it is stuck 0.65 s after it stays, so far from its set point."""
        rest = angle(until)
        return followed(
            lambda t: sign * (angle(t) if t <= until else rest),
            lambda t: sign * (set_point(t) if t <= until else rest + gap),
            until + 0.65,
        ).stuck

    assert stuck(lambda t: 3.0 * t, lambda t: 3.0 * t + 2.0, 1.5), "it goes towards its set point"
    assert stuck(lambda t: t, lambda t: t - (2.0 if t > 0.5 else -2.0), 1.0), "it goes on for a moment of dead time"
    assert stuck(lambda t: 0.7 * t, lambda t: 0.7 * t - 2.0, 1.5), "it hardly moves"
    assert stuck(lambda t: 2.0 * min(t, 0.4) - max(t - 0.4, 0.0), lambda t: -2.0, 0.61), "it has turned round"


def test_how_far_it_stands_off_is_forgotten_as_well():
    following = stands_off(2.3)
    following.reset()
    for tick in range(14):
        following.add(6.0 + 0.05 * tick, 3.6 * DEGREE, 0.0, 6.0 + 0.05 * tick)
    assert following.stuck


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


def test_an_angle_may_turn_as_fast_as_is_set_and_no_faster():
    settings = DriveSettings(jump_angle=0.25, jump_rate=0.5)
    for leap, jumped in ((0.5, False), (math.nextafter(0.5, 1.0), True)):  # 0.25 rad, and 0.5 s of 0.5 rad/s
        following = Following(settings)
        for time, angle in ((1.0, 0.0), (1.5, leap), (2.0, leap)):
            following.add(time, 0.0, angle, time)
        assert following.jumped is jumped


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
