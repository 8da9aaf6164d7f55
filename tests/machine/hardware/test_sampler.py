"""The sampler: which epochs become measurements, and what is measured where none comes."""

import math
from dataclasses import fields

import pytest

from drawbar.machine.hardware.sampler import WAIT, Sampler
from drawbar.messages import Fixes
from drawbar.signals import FixQuality

SECOND = 1_000_000_000


def fixes(epoch, **given):
    values = dict.fromkeys((field.name for field in fields(Fixes)), 0)
    values |= {"epoch": epoch, "tractor_x": 1.0, "tractor_y": 2.0, "trailer_x": -3.0, "trailer_y": 0.5}
    values |= {"tractor_quality": 5, "trailer_quality": 4, "wheel_speed": math.nan, "tractor_speed": 0.7}
    return Fixes(**(values | given))


def test_nothing_begins_without_both_antennas():
    sampler = Sampler(0.2)
    assert sampler.take(fixes(SECOND, trailer_x=math.nan)) is None
    assert sampler.deadline is None
    assert sampler.take(fixes(2 * SECOND)).time == 0.0


def test_time_is_the_receivers_and_begins_with_the_first_epoch():
    sampler = Sampler(0.2)
    begin = 5 * SECOND
    times = [sampler.take(fixes(begin + k * SECOND // 5)).time for k in range(4)]
    assert times == pytest.approx([0.0, 0.2, 0.4, 0.6], abs=1e-12)


def test_a_faster_receiver_gives_every_second_epoch():
    sampler = Sampler(0.2)
    taken = [sampler.take(fixes(SECOND + k * SECOND // 10)) for k in range(7)]
    assert [measured is not None for measured in taken] == [True, False, True, False, True, False, True]
    assert sampler.dropped == 3


def test_an_epoch_that_was_left_out_is_seen_in_the_time():
    sampler = Sampler(0.2)
    sampler.take(fixes(SECOND))
    assert sampler.take(fixes(SECOND + 3 * SECOND // 5)).time == pytest.approx(0.6)


def test_an_epoch_that_comes_twice_or_too_late_is_dropped():
    sampler = Sampler(0.2)
    sampler.take(fixes(SECOND))
    missed = sampler.miss()
    assert sampler.take(fixes(SECOND)) is None
    assert sampler.take(fixes(SECOND + SECOND // 5)) is None  # its sample has been taken without it
    assert missed.time == pytest.approx(0.2)
    assert math.isnan(missed.tractor_x)
    assert missed.tractor_fix_quality is FixQuality.NONE
    assert sampler.dropped == 2


def test_a_sample_waits_no_longer_than_it_can():
    sampler = Sampler(0.2)
    sampler.take(fixes(SECOND))
    assert sampler.deadline == SECOND + SECOND // 5 + WAIT


def test_quality_and_speed_come_with_the_fix():
    measured = Sampler(0.2).take(fixes(SECOND))
    assert measured.tractor_fix_quality is FixQuality.FIXED
    assert measured.trailer_fix_quality is FixQuality.FLOAT
    assert measured.speed == 0.7
    assert Sampler(0.2).take(fixes(SECOND, wheel_speed=0.8)).speed == 0.8


def test_ages_count_back_from_the_epoch():
    measured = Sampler(0.2).take(fixes(SECOND, hitch_angle=0.1, hitch_angle_time=SECOND - 30_000_000))
    assert measured.hitch_angle_age == pytest.approx(0.03)
    assert Sampler(0.2).take(fixes(SECOND, hitch_angle_time=SECOND + 1)).hitch_angle_age == 0.0
