"""The sampler: which epochs become measurements, and what is measured where none comes."""

import math
from itertools import pairwise

import pytest
from fixes import fixes_of

from drawbar.machine.hardware.sampler import Sampler
from drawbar.signals import FixQuality

SECOND = 1_000_000_000
DELAY = 50_000_000
"""of epochs, ns"""


def fixes(epoch, delay=DELAY, **given):
    values = {"epoch": epoch, "time": epoch + delay}
    values |= {"tractor_x": 1.0, "tractor_y": 2.0, "trailer_x": -3.0, "trailer_y": 0.5}
    values |= {"tractor_quality": 5, "trailer_quality": 4, "wheel_speed": math.nan, "tractor_speed": 0.7}
    return fixes_of(**(values | given))


@pytest.mark.parametrize("alone", ["tractor_x", "trailer_x"])
def test_samples_begin_with_the_first_epoch_also_of_one_receiver_that_no_other_joins(alone):
    sampler = Sampler(0.2)
    assert sampler.deadline is None
    taken = [sampler.take(fixes(SECOND + k * SECOND // 5, **{alone: math.nan})) for k in range(3)]
    assert [measured.time for measured in taken] == pytest.approx([0.0, 0.2, 0.4])
    both = [sampler.take(fixes(SECOND + k * SECOND // 5)) for k in (3, 4)]
    assert [measured.time for measured in both] == pytest.approx([0.6, 0.8])


def test_where_the_trailer_has_no_receiver_the_tractors_antenna_is_enough():
    sampler = Sampler(0.2, has_trailer=False)
    measured = sampler.take(fixes(2 * SECOND, trailer_x=math.nan, tractor_yaw=0.3))
    assert (measured.time, measured.tractor_yaw) == (0.0, 0.3)
    assert [sampler.take(fixes(2 * SECOND + k * SECOND // 5, trailer_x=math.nan)).time for k in (1, 2)] == [0.2, 0.4]


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


@pytest.mark.parametrize("rate", [10, 15, 20, 25, 50])
@pytest.mark.parametrize("every", [1, 2, 4])
def test_of_frequent_epochs_that_nearest_to_the_next_sample_counts(rate, every):
    """A step that is shorter each time would end the run; maybe only every second or fourth epoch is of both."""
    sampler, samples = Sampler(0.2), []
    for k in range(5 * rate):
        if rate // 5 % every == 0:
            given = {"trailer_x": math.nan} if k % every else {}
            samples.append(sampler.take(fixes(SECOND + k * SECOND // rate, DELAY + k % 3 * 1_000_000, **given)))
    taken = [measured for measured in samples if measured is not None]
    assert [measured.time for measured in taken] == pytest.approx([0.2 * k for k in range(len(taken))], abs=0.003)
    assert all(measured.trailer_x == -3.0 for measured in taken)


def test_a_sample_without_an_epoch_has_the_speed_of_one_that_came_too_soon_for_a_sample():
    sampler = Sampler(0.2)
    sampler.take(fixes(SECOND))
    assert sampler.take(fixes(SECOND + SECOND // 10, wheel_speed=1.5)) is None
    measured = sampler.miss()
    assert measured.speed == 1.5
    assert math.isnan(measured.tractor_x)
    assert (measured.tractor_fix_quality, measured.trailer_fix_quality) == (FixQuality.NONE, FixQuality.NONE)


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


@pytest.mark.parametrize(("sample_time", "wait"), [(0.2, 0.1), (0.1, 0.075), (0.05, 0.0375)])
def test_a_sample_waits_no_longer_than_it_can(sample_time, wait):
    sampler = Sampler(sample_time)
    sampler.take(fixes(SECOND))
    assert sampler.deadline == SECOND + DELAY + round(1e9 * (sample_time + wait))


def test_a_report_of_the_sensor_board_takes_no_epochs_place_and_is_known_where_none_comes():
    sampler, none = Sampler(0.2), {"tractor_x": math.nan, "trailer_x": math.nan}
    sampler.take(fixes(SECOND))
    assert math.isnan(sampler.miss().hitch_angle)
    for k in range(3):  # the last one a millisecond before the epoch that is due
        now = SECOND + DELAY + (320 + 39 * k + k // 2) * SECOND // 1000
        report = {"hitch_angle": 0.1, "hitch_angle_time": now, "wheel_speed": 1.5, "wheel_speed_time": now}
        assert sampler.take(fixes(now, delay=0, **none, **report)) is None
    assert sampler.take(fixes(SECOND + 2 * SECOND // 5)).time == pytest.approx(0.4)
    missed = sampler.miss()
    assert (missed.time, missed.hitch_angle, missed.speed) == pytest.approx((0.6, 0.1, 1.5))
    assert missed.hitch_angle_age == pytest.approx(0.201)
    assert math.isnan(sampler.miss().hitch_angle)  # an old one says nothing
    assert sampler.dropped == 0


def test_quality_and_speed_come_with_the_fix():
    measured = Sampler(0.2).take(fixes(SECOND))
    assert measured.tractor_fix_quality is FixQuality.FIXED
    assert measured.trailer_fix_quality is FixQuality.FLOAT
    assert measured.speed == 0.7
    assert Sampler(0.2).take(fixes(SECOND, wheel_speed=0.8)).speed == 0.8


def test_the_trailers_receiver_reports_the_speed_while_the_tractors_does_not():
    """Without a wheel encoder, no speed would be known else: the vehicle would have to stop for it, and never stand."""
    silent = {"tractor_x": math.nan, "tractor_y": math.nan, "tractor_speed": math.nan, "trailer_speed": 0.6}
    assert Sampler(0.2).take(fixes(SECOND, **silent)).speed == 0.6
    assert Sampler(0.2).take(fixes(SECOND, wheel_speed=0.8, **silent)).speed == 0.8
    assert Sampler(0.2).take(fixes(SECOND, trailer_speed=0.6)).speed == 0.7


def test_ages_count_back_from_the_sample_at_which_the_epoch_is_here():
    measured = Sampler(0.2).take(fixes(SECOND, hitch_angle=0.1, hitch_angle_time=SECOND - 30_000_000))
    assert measured.hitch_angle_age == pytest.approx(0.08)
    assert (measured.tractor_fix_age, measured.trailer_fix_age) == pytest.approx((0.05, 0.05))
    late = SECOND + DELAY + 1
    assert Sampler(0.2).take(fixes(SECOND, hitch_angle_time=late)).hitch_angle_age == 0.0


def sampled(epochs):
    """Return the samples of epochs, (time, delay) in ns, that come as a control loop hears them; None: one missed."""
    sampler, samples = Sampler(0.2), []
    for epoch, delay in epochs:
        while sampler.deadline is not None and sampler.deadline <= epoch + delay:
            samples.append(sampler.miss())
        measured = sampler.take(fixes(epoch, delay))
        samples += [measured] if measured is not None else []
    return samples


@pytest.mark.parametrize("delay", [0, 30, 59, 61, 100, 150, 250, 400, 1000])
def test_no_epoch_is_lost_however_long_each_takes(delay):
    samples = sampled([(SECOND + k * SECOND // 5, delay * 1_000_000) for k in range(20)])
    assert len(samples) == 20
    for k, measured in enumerate(samples):
        assert measured.time == pytest.approx(0.2 * k)
        assert measured.tractor_x == 1.0
        assert measured.tractor_fix_age == pytest.approx(delay * 1e-3)


@pytest.mark.parametrize("burst", range(10, 600, 10))
@pytest.mark.parametrize("rate", [5, 10, 20])
def test_epochs_are_measured_though_the_first_were_held_up(burst, rate):
    """As where a connection begins with what has waited: the least delay, and with it each instant, is known later."""
    begin, step, held = SECOND, SECOND // rate, burst * 1_000_000
    arrival = begin + DELAY + held
    epochs = [(begin + k * step, max(arrival - begin - k * step, DELAY)) for k in range(3 * rate)]
    after = [measured for measured in sampled(epochs) if measured.time > 1.2]
    assert len(after) >= 5
    assert all(measured.tractor_x == 1.0 for measured in after)
    assert all(measured.tractor_fix_age == pytest.approx(0.05) for measured in after)


@pytest.mark.parametrize("shift", range(-290, 300, 10))
@pytest.mark.parametrize("rate", [5, 10])
def test_epochs_that_go_on_at_other_times_are_measured(shift, rate):
    """As after a receiver's clock was set, or its delay has changed for good: few are missed, and no time runs back."""
    step = SECOND // rate
    moved = [SECOND + k * step + (k >= 2 * rate) * shift * 1_000_000 for k in range(4 * rate)]
    samples = sampled([(epoch, DELAY) for epoch in moved])
    times = [measured.time for measured in samples]
    assert min(later - earlier for earlier, later in pairwise(times)) > 0.04
    assert sum(math.isnan(measured.tractor_x) for measured in samples) <= 3
    assert not any(math.isnan(measured.tractor_x) for measured in samples[-5:])


@pytest.mark.parametrize("later", range(10, 600, 20))
def test_a_delay_that_grows_for_good_costs_a_second_at_most(later):
    delays = [DELAY + (k >= 10) * later * 1_000_000 for k in range(30)]
    samples = sampled([(SECOND + k * SECOND // 5, delay) for k, delay in enumerate(delays)])
    assert all(measured.tractor_x == 1.0 for measured in samples[-8:])
    assert samples[-1].tractor_fix_age == pytest.approx(0.05 + later * 1e-3)
    assert sum(math.isnan(measured.tractor_x) for measured in samples) <= 8


def test_one_lost_epoch_does_not_move_the_samples_of_a_faster_receiver():
    epochs = [(SECOND + k * SECOND // 10, DELAY) for k in range(20) if k != 8]
    samples = sampled(epochs)
    assert [measured.time for measured in samples] == pytest.approx([0.2 * k for k in range(10)])
    assert [math.isnan(measured.tractor_x) for measured in samples] == [k == 4 for k in range(10)]


@pytest.mark.parametrize("after", range(10, 200, 10))
def test_each_sample_is_nearly_a_sample_time_after_the_last_where_epochs_are_of_one_antenna(after):
    """As where a receiver sets its clock, no epoch is of both; the estimator takes each step for a whole one."""
    sampler, times = Sampler(0.2), []
    for k in range(40):
        begin = SECOND + k * SECOND // 5
        alone = [(begin, {"trailer_x": math.nan}), (begin + after * 1_000_000, {"tractor_x": math.nan})]
        for epoch, given in [(begin, {})] if k < 10 else alone:
            while sampler.deadline is not None and sampler.deadline <= epoch + DELAY:
                times.append(sampler.miss().time)
            measured = sampler.take(fixes(epoch, **given))
            times += [measured.time] if measured is not None else []
    assert min(later - earlier for earlier, later in pairwise(times)) >= 0.15 - 1e-9


@pytest.mark.parametrize("rate", [10, 20, 25, 50])
@pytest.mark.parametrize("ahead", range(1, 10))
def test_samples_move_to_the_epochs_of_both_receivers_however_soon_these_come_after_the_last(rate, ahead):
    """The tractor's receiver is silent for a moment, in which the samples stand beside the instants of both."""
    step = SECOND // rate
    sampler, samples = Sampler(0.2), []
    for k in range(4 * rate):
        both = (k - ahead) % (rate // 5) == 0 and k >= rate
        given = {} if both or k == 0 else {"tractor_x": math.nan}
        while sampler.deadline is not None and sampler.deadline <= SECOND + k * step + DELAY:
            samples.append(sampler.miss())
        measured = sampler.take(fixes(SECOND + k * step, **given))
        samples += [measured] if measured is not None else []
    assert all(measured.tractor_x == 1.0 for measured in samples[-9:])
    steps = [later.time - earlier.time for earlier, later in pairwise(samples)]
    assert 0.15 - 1e-9 <= min(steps) <= max(steps) <= 0.35 + 1e-9


@pytest.mark.parametrize("sample_time", [0.1, 0.2, 1.0])
@pytest.mark.parametrize("share", [0.05 * step for step in range(1, 20)])
def test_samples_move_to_the_epochs_of_the_only_receiver_that_is_left(sample_time, share):
    """The trailer's receiver is silent for good, the tractor's for a moment, and then goes on at other instants."""
    sampler, samples = Sampler(sample_time), []
    for k in [*range(10), *(k + share for k in range(14, 40))]:
        epoch = SECOND + round(k * sample_time * SECOND)
        while sampler.deadline is not None and sampler.deadline <= epoch + DELAY:
            samples.append(sampler.miss())
        measured = sampler.take(fixes(epoch, **({"trailer_x": math.nan} if k >= 10 else {})))
        samples += [measured] if measured is not None else []
    assert all(measured.tractor_x == 1.0 for measured in samples[-15:])
    assert min(later.time - earlier.time for earlier, later in pairwise(samples)) >= 0.75 * sample_time - 1e-9


@pytest.mark.parametrize("away", range(4))
def test_samples_stay_with_the_slower_receiver(away):
    """Tractor at 10 Hz, trailer at 5; both fall silent for a second, then continue where they like."""
    epochs = [
        (SECOND + k * SECOND // 10, {} if k % 2 == 0 else {"trailer_x": math.nan})
        for k in range(60)
        if not 20 <= k < 30 + away
    ]
    sampler, samples = Sampler(0.2), []
    for epoch, given in epochs:
        while sampler.deadline is not None and sampler.deadline <= epoch + DELAY:
            samples.append(sampler.miss())
        measured = sampler.take(fixes(epoch, **given))
        samples += [measured] if measured is not None else []
    assert all(measured.trailer_x == -3.0 for measured in samples[-10:])
    assert all(measured.tractor_x == 1.0 for measured in samples[-10:])


def test_a_late_epoch_from_before_the_last_sample_moves_no_sample():
    """Found with a fifth of both receivers' epochs 0.25 s late: a repeated time, and the steering was released."""
    sampler = Sampler(0.2)
    epochs = [SECOND + k * SECOND // 5 for k in range(8)]
    for epoch in epochs[:5]:
        sampler.take(fixes(epoch, 60_000_000))
    tractor, trailer = {"trailer_x": math.nan}, {"tractor_x": math.nan}
    sampler.take(fixes(epochs[5], 125_000_000, **tractor, **trailer))
    sampler.take(fixes(epochs[6], 100_000_000, **trailer))
    assert sampler.take(fixes(epochs[5], 375_000_000, **tractor)) is None
    missed = sampler.miss()
    assert sampler.take(fixes(epochs[6], 290_000_000, **tractor)) is None
    later = sampler.take(fixes(epochs[7], 100_000_000, **trailer))
    assert later is None or later.time > missed.time + 0.1
