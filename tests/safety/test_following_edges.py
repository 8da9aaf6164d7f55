"""Whether a steering follows, at the edge of each limit: numbers that floating point has exactly."""

import math

import pytest

from drawbar.safety.following import Following
from drawbar.safety.settings import DriveSettings

TICK = 1.0 / 16.0
FAR, MOVE, AWAY = 1.0 / 4.0, 1.0 / 16.0, 1.0 / 8.0
SETTINGS = DriveSettings(
    stuck_time=0.5, stuck_angle=FAR, stuck_move=MOVE, reversed_time=0.25, reversed_angle=AWAY, jump_angle=1.0
)
NEAR, REST, SIDE = 2.0 / 3.0 * FAR, 0.2 * MOVE, math.radians(1.0)
"""all in rad and s"""


def followed(*samples, every=TICK):
    """Return what is said after these gaps from the set point, with the angles (rad) at which they were."""
    following = Following(SETTINGS)
    for tick, (gap, angle) in enumerate(samples):
        following.add(every * tick, angle + gap, angle, every * tick)
    return following


def below(number):
    return math.nextafter(number, 0.0)


def moving(by, ticks, gap=FAR):
    """Return one sample, and the samples of so many ticks in which the angle moves evenly."""
    return [(gap, 0.0), *((gap, by * tick / ticks) for tick in range(ticks + 1))]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_that_moves_as_far_as_a_stuck_one_may_not_is_not_stuck(sign):
    def stuck(by):
        return followed(*((sign * gap, sign * angle) for gap, angle in moving(by, 8))).stuck

    assert not stuck(MOVE)
    assert stuck(0.75 * MOVE)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_that_moves_to_and_fro_as_far_off_as_the_limit_is_stuck(sign):
    def stuck(gap):
        angles = [0.0, 0.0, MOVE, 2.0 * MOVE, MOVE, 0.0, MOVE, 2.0 * MOVE, MOVE, 0.0]
        return followed(*((sign * gap, sign * angle) for angle in angles)).stuck

    assert stuck(FAR)
    assert not stuck(0.5 * FAR)


def test_one_that_rests_as_far_off_as_the_limit_on_changing_sides_is_stuck():
    def stuck(gap):
        return followed(*(((-1.0) ** tick * gap, 0.0) for tick in range(10))).stuck

    assert stuck(FAR)
    assert not stuck(below(FAR))


def test_few_samples_are_enough():
    assert followed(*(((-1.0) ** tick * FAR, 0.0) for tick in range(4)), every=0.25).stuck


def test_the_mean_of_each_half_counts():
    gaps = [0.0, 0.875, 0.875, 0.875, 1.375, 1.0, 1.0, 1.0, 1.0, 1.0]
    assert followed(*((FAR * gap, 0.0) for gap in gaps)).stuck
    assert not followed(*((FAR * gap, 0.0) for gap in [*gaps[:4], 1.25, *gaps[5:]])).stuck


def test_one_that_rests_after_a_third_of_the_time_as_far_off_as_the_limit_is_stuck():
    def stuck(gap, by=0.0):
        return followed((gap, 0.0), *((gap if tick < 3 else 0.0, by * tick / 8) for tick in range(9))).stuck

    assert stuck(FAR)
    assert not stuck(below(FAR))
    assert not stuck(FAR, REST)
    assert stuck(FAR, 0.75 * REST)
    assert not followed(*((gap, 0.0) for gap in [FAR, FAR, FAR, *[0.0] * 7])).stuck, "two of nine samples"


def test_one_that_rests_less_far_off_for_four_times_as_long_is_stuck():
    def stuck(gap, by=0.0, ticks=32):
        return followed(*moving(by, ticks, gap)).stuck

    assert stuck(NEAR)
    assert not stuck(NEAR, ticks=31)
    assert not stuck(below(NEAR))
    assert not stuck(NEAR, REST)
    assert stuck(NEAR, 0.75 * REST)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_that_moves_away_as_far_as_the_limit_is_not_yet_reversed(sign):
    def reverses(by, gap=SIDE):
        away = [(gap + by * tick / 4, -by * tick / 4) for tick in range(5)]
        return followed((sign * gap, 0.0), *((sign * apart, sign * angle) for apart, angle in away)).reversed

    assert not reverses(AWAY)
    assert reverses(1.5 * AWAY)
    assert not reverses(1.5 * AWAY, below(SIDE)), "its set point was not on one side"


def test_one_that_has_just_come_to_rest_is_not_reversed():
    def reverses(last):
        angles = [0.0, 0.0, -AWAY, -2.0 * AWAY, -3.0 * AWAY, last]
        return followed(*((0.5 - angle, angle) for angle in angles)).reversed

    assert not reverses(-3.0 * AWAY)
    assert reverses(-3.25 * AWAY)


def stands_off(by, begins=FAR / 2.0, ticks=8):
    """Return what is said of one that moves away from a set point at rest, and rests when that goes further."""
    away = [(begins + by * share, -by * share) for share in (min(tick / ticks, 1.0) for tick in range(9))]
    return followed((begins, 0.0), *away, *((1.1 * FAR, -by) for _ in range(9))).stuck


def test_one_that_moves_away_as_far_as_a_stuck_one_may_not_is_forgiven_what_it_stands_off():
    assert not stands_off(MOVE)
    assert stands_off(0.75 * MOVE)
    assert stands_off(MOVE, begins=0.0), "it stood on its set point"
    assert stands_off(MOVE, ticks=4), "it has come to rest"
