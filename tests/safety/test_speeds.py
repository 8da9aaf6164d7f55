"""The vehicle's speed as the gate knows it: which source counts, for how long, and whether it stands."""

import math

import pytest

from drawbar.safety.settings import SafetySettings
from drawbar.safety.speeds import Speeds

SETTINGS = SafetySettings()


def test_the_largest_recent_speed_counts():
    speeds = Speeds(SETTINGS)
    assert speeds.largest(10.0) == 4.2
    assert not speeds.known(10.0)
    for index, value in enumerate([2.0, 1.0, 1.0, 1.0, 1.0, 1.0]):
        speeds.add(10.0 + 0.1 * index, "wheels", value)
    speeds.add(10.5, "receiver", -1.2)
    assert speeds.known(10.5)
    assert speeds.largest(10.5) == 2.0
    assert speeds.last == -1.2
    speeds.add(10.6, "wheels", 1.0)
    assert speeds.largest(10.6) == 1.2, "six of each source"


def test_old_or_missing_speeds_do_not_count():
    speeds = Speeds(SETTINGS)
    speeds.add(10.0, "wheels", 1.0)
    speeds.add(10.2, "receiver", math.nan)
    assert speeds.last == 1.0
    assert speeds.known(10.5)
    assert speeds.largest(10.0) == 1.0
    assert speeds.fresh(10.5) == {"wheels": 1.0}
    assert not speeds.known(10.51)
    assert speeds.largest(10.51) == pytest.approx(1.0 + 1.5 * 0.51)
    speeds.add(10.6, "receiver", 0.5)
    assert speeds.largest(10.6) == 0.5, "what the wheels said is too old"


@pytest.mark.parametrize(("receiver", "known"), [(1.5, True), (1.51, False), (0.5, True), (0.49, False), (-1.0, True)])
def test_sources_that_disagree_are_not_believed(receiver, known):
    speeds = Speeds(SETTINGS)
    speeds.add(10.0, "wheels", 1.0)
    speeds.add(10.0, "receiver", receiver)
    assert speeds.known(10.0) is known


@pytest.mark.parametrize(
    ("receiver", "known"), [([1.5, 2.0, 1.4], True), ([1.5, 1.4, 1.4], False), ([2.0, 0.4], False)]
)
def test_means_are_compared_as_an_antenna_sways_on_its_mast(receiver, known):
    speeds = Speeds(SETTINGS)
    speeds.add(9.4, "receiver", 2.0)
    for index, value in enumerate(receiver):
        speeds.add(10.2 - 0.2 * (len(receiver) - 1 - index), "receiver", value)
        speeds.add(10.2 - 0.2 * (len(receiver) - 1 - index), "wheels", 2.0)
    assert speeds.known(10.2) is known


def means(*receiver):
    """Return whether the speed is known after these of the receiver, while the wheels say 1 m/s."""
    speeds = Speeds(SETTINGS)
    for index, value in enumerate(receiver):
        speeds.add(10.0 + 0.0625 * index, "receiver", value)
        speeds.add(10.0 + 0.0625 * index, "wheels", 1.0)
    return speeds.known(10.0 + 0.0625 * (len(receiver) - 1))


def test_the_mean_is_of_three_samples_and_the_newest_counts_three_times():
    assert not means(0.0, 1.6, 1.6, 1.6)
    assert means(3.4, 1.0, 1.0)
    assert not means(3.6, 1.0, 1.0)
    assert means(1.0, 1.0, 1.8)
    assert not means(1.0, 1.0, 1.875)
    assert not means(1.0, 3.6, 1.0)


def contradicting(wheels, receiver, first=10.0, count=6):
    """Return whether speeds contradict each other after so many of each, which came within 1 s, at the time 11 s."""
    speeds = Speeds(SETTINGS)
    for index in range(count):
        speeds.add(first if index == 0 else 11.0, "wheels", wheels)
        speeds.add(first if index == 0 else 11.0, "receiver", receiver)
    return speeds.contradict(11.0)


@pytest.mark.parametrize("turned", [False, True])
def test_speeds_of_which_one_is_half_as_large_again_do_not_yet_contradict(turned):
    def contradict(*speeds, **how):
        return contradicting(*(reversed(speeds) if turned else speeds), **how)

    assert not contradict(2.0, 3.0)
    assert contradict(2.0, 3.125)
    assert not contradict(0.05, 0.125), "a small difference"
    assert not contradict(0.0, 0.09375)
    assert contradict(0.0, 0.125)
    assert not contradict(2.0, 4.0, count=5), "too few of them"
    assert contradict(2.0, 4.0, first=8.0)
    assert not contradict(2.0, 4.0, first=math.nextafter(8.0, 0.0)), "the first is too old"


def test_while_it_is_not_known_it_grows_no_faster_than_the_vehicle_can():
    speeds = Speeds(SETTINGS)
    for tick in range(6):
        speeds.add(10.0 + 0.2 * tick, "wheels", 2.0)
        assert speeds.largest(10.0 + 0.2 * tick) == (2.0 if tick == 0 else 2.1)
        speeds.add(10.0 + 0.2 * tick, "receiver", 2.1 if tick < 5 else 3.9)
    assert not speeds.known(11.0)
    assert speeds.largest(11.0) == pytest.approx(2.1)
    assert speeds.largest(12.0) == pytest.approx(3.6)
    assert speeds.largest(13.0) == 4.2
    speeds.add(13.0, "wheels", 3.9)
    speeds.add(13.0, "receiver", 3.9)
    assert speeds.largest(13.0) == 3.9


def test_what_boards_are_told_follows_no_false_report():
    speeds = Speeds(SETTINGS)
    assert speeds.believable(9.9) == 0.0, "none has come"
    reports = [(2.0, 2.0), (2.0, -2.1), (2.0, 10.0), (0.0, 2.0), (1.9, math.nan), (math.nan, math.nan)]
    told = []
    for tick, (wheels, receiver) in enumerate(reports):
        speeds.add(12.0 + 0.2 * tick, "wheels", wheels)
        speeds.add(12.0 + 0.2 * tick, "receiver", receiver)
        told.append(speeds.believable(12.0 + 0.2 * tick))
    assert told == pytest.approx([2.0, 2.1, 2.4, 2.0, 2.0, 2.0])
    assert speeds.believable(14.0) == 1.9, "none is fresh"
    speeds.add(14.1, "receiver", 10.0)
    assert speeds.believable(14.1) == SETTINGS.envelope.speed, "as fast as this machine is ever driven"
    speeds.add(14.3, "receiver", 0.0)
    assert speeds.believable(14.3) == 0.0, "at once"


def test_it_stands_only_for_certain():
    speeds = Speeds(SETTINGS)
    assert not speeds.stands(10.0, 0.05)
    speeds.add(10.0, "wheels", 0.05)
    assert speeds.stands(10.0, 0.05)
    speeds.add(10.0, "receiver", -0.06)
    assert not speeds.stands(10.0, 0.05)
    assert not speeds.stands(11.0, 0.05)


@pytest.mark.parametrize(("period", "found"), [(0.2, True), (0.4, True), (0.575, True), (0.6, False), (1.0, False)])
def test_speeds_of_another_time_contradict_nothing(period, found):
    # a receiver that sends once a second tells the mean of five seconds, in which a vehicle halves its speed
    speeds = Speeds(SETTINGS)
    for index in range(6):
        speeds.add(16.0 - period * (5 - index), "receiver", 2.0)
        speeds.add(16.0 - 0.2 * (5 - index), "wheels", 1.0)
    assert speeds.contradict(16.1) is found
