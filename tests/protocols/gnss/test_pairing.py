"""Pairing: epochs of two receivers by their own times, whatever the order and the delay in which they come."""

import math
import random
from dataclasses import replace

import pytest
from receiver_frames import nmea, sbf

from drawbar.protocols.gnss.checks import resolution
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.pairing import Body, Pair, Pairing
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.gnss.stream import EpochStream

TRACTOR, TRAILER = Body.TRACTOR, Body.TRAILER


def epoch(utc: float) -> Epoch:
    return Epoch(time=utc, received=utc, utc=utc % 86400.0, latitude=50.0, longitude=4.0)


def times(pairs: list[Pair]) -> list[tuple[float | None, float | None]]:
    return [tuple(None if each is None else each.utc for each in (pair.tractor, pair.trailer)) for pair in pairs]


def run(arrivals: list[tuple[float, Body, float]]) -> tuple[list[tuple[float | None, float | None]], dict[str, int]]:
    """Add epochs (arrival, body, utc) and wait at the end."""
    pairing, pairs = Pairing(), []
    for arrival, body, utc in arrivals:
        pairs += pairing.add(body, epoch(utc), arrival)
    pairs += pairing.poll(1e9)
    assert pairing.due == math.inf
    return times(pairs), pairing.dropped


@pytest.mark.parametrize("first", [TRACTOR, TRAILER])
def test_the_same_instant_is_a_pair_as_soon_as_both_are_there(first: Body) -> None:
    pairing = Pairing()
    second = TRAILER if first is TRACTOR else TRACTOR
    assert pairing.add(first, epoch(100.0), 5.0) == []
    assert pairing.due == pytest.approx(5.06)
    assert times(pairing.add(second, epoch(100.001), 5.03)) == [
        tuple(100.0 if first is body else 100.001 for body in Body)
    ]
    assert pairing.dropped == {}


def test_the_second_is_waited_for_60_ms_and_then_goes_alone() -> None:
    pairing = Pairing()
    pairing.add(TRACTOR, epoch(100.0), 5.0)
    assert pairing.poll(5.059) == []
    assert times(pairing.poll(5.061)) == [(100.0, None)]
    assert times(pairing.add(TRAILER, epoch(100.0), 5.1) + pairing.poll(5.2)) == [(None, 100.0)]
    assert pairing.dropped == {"tractor alone": 1, "trailer alone": 1}


def test_one_receiver_alone_gives_every_epoch() -> None:
    pairs, dropped = run([(0.1 * step, TRACTOR, 0.1 * step) for step in range(5)])
    assert pairs == [(pytest.approx(0.1 * step), None) for step in range(5)]
    assert dropped == {"tractor alone": 5}


@pytest.mark.parametrize(("offset", "apart"), [(0.04, 0.04), (-0.04, -0.04), (0.06, -0.04)])
def test_half_an_interval_is_the_same_instant(offset: float, apart: float) -> None:
    arrivals = [(0.1 * step, TRACTOR, 0.1 * step) for step in range(20)]
    arrivals += [(0.1 * step + 0.01, TRAILER, 0.1 * step + offset) for step in range(20)]
    pairs, _ = run(sorted(arrivals, key=lambda each: each[0]))
    both = [second - first for first, second in pairs if first is not None and second is not None]
    assert len(both) >= 15
    assert both[-10:] == pytest.approx([apart] * 10)


@pytest.mark.parametrize("late", [TRACTOR, TRAILER])
@pytest.mark.parametrize("behind", [0.0, 0.05, 0.07, 0.15, 0.21, 0.35, 0.45])
@pytest.mark.parametrize("rate", [5, 10, 20])
def test_a_receiver_that_is_always_later_is_waited_for(late: Body, behind: float, rate: int) -> None:
    early = TRAILER if late is TRACTOR else TRACTOR
    arrivals = [(step / rate, early, step / rate) for step in range(40)]
    arrivals += [(step / rate + behind, late, step / rate) for step in range(40)]
    pairs, dropped = run(sorted(arrivals, key=lambda each: each[0]))
    learned = math.ceil(behind * rate) + 1
    assert pairs[-(40 - learned) :] == [(pytest.approx(step / rate),) * 2 for step in range(learned, 40)]
    assert sum(dropped.values()) <= 2 * learned


def test_who_was_later_once_is_not_waited_for_longer() -> None:
    arrivals = [(0.2 * step, TRACTOR, 0.2 * step) for step in range(10)]
    arrivals += [(0.2 * step + (0.15 if step == 4 else 0.02), TRAILER, 0.2 * step) for step in range(10)]
    pairing = Pairing()
    for arrival, body, utc in sorted(arrivals, key=lambda each: each[0]):
        pairing.add(body, epoch(utc), arrival)
    pairing.add(TRACTOR, epoch(2.0), 2.0)
    assert pairing.due == pytest.approx(2.08)


@pytest.mark.parametrize("seed", range(5))
def test_what_is_due_ends_a_wait_however_the_usual_delay_changes(seed: int) -> None:
    chance, pairing = random.Random(seed), Pairing()
    arrivals = [(0.1 * step + chance.uniform(0.0, 0.45), body, 0.1 * step) for step in range(300) for body in Body]
    for arrival, body, utc in sorted(arrivals, key=lambda each: each[0]):
        while (due := pairing.due) <= arrival:
            assert pairing.poll(due)
        pairing.add(body, epoch(utc), arrival)


def test_one_that_is_half_a_second_behind_stays_alone() -> None:
    arrivals = [(0.2 * step, TRACTOR, 0.2 * step) for step in range(20)]
    arrivals += [(0.2 * step + 0.55, TRAILER, 0.2 * step) for step in range(20)]
    pairs, dropped = run(sorted(arrivals, key=lambda each: each[0]))
    assert dropped == {"tractor alone": 20, "trailer alone": 20}
    assert len(pairs) == 40


def test_receivers_of_two_rates_pair_where_they_meet() -> None:
    arrivals = [(0.1 * step, TRACTOR, 0.1 * step) for step in range(20)]
    arrivals += [(0.2 * step + 0.03, TRAILER, 0.2 * step) for step in range(10)]
    pairs, _ = run(sorted(arrivals, key=lambda each: each[0]))
    assert len(pairs) == 20
    assert sum(None not in pair for pair in pairs) == 10


def test_half_an_interval_is_that_of_the_faster_receiver() -> None:
    arrivals = [(0.1 * step, TRACTOR, 0.1 * step) for step in range(20)]
    arrivals += [(0.2 * step + 0.05, TRAILER, 0.2 * step + 0.06) for step in range(10)]  # nearer to the next tractor's
    pairs, _ = run(sorted(arrivals, key=lambda each: each[0]))
    both = [(first, second) for first, second in pairs if first is not None and second is not None]
    assert len(both) >= 8
    assert [first - second for first, second in both[-8:]] == pytest.approx([0.04] * 8)


def test_epochs_that_are_lost_make_no_pair_of_two_instants() -> None:
    arrivals = [(0.2 * step + 0.18 * (step == 11), TRACTOR, 0.2 * step) for step in range(20) if step not in (9, 10)]
    arrivals += [
        (0.2 * step - 0.03 * (step == 12), TRAILER, 0.2 * step) for step in range(20) if step not in (9, 10, 11)
    ]
    pairs, _ = run(sorted(arrivals, key=lambda each: each[0]))
    assert [pair for pair in pairs if None in pair] == [(pytest.approx(2.2), None)]
    assert all(first == second for first, second in pairs if first is not None and second is not None)


@pytest.mark.parametrize("body", Body)
def test_one_wrong_time_leaves_the_interval_as_it_is(body: Body) -> None:
    arrivals = [(0.2 * step, TRACTOR, 0.2 * step) for step in range(20)]
    arrivals += [(0.2 * step + 0.001, TRAILER, 0.2 * step + 0.004) for step in range(20)]
    arrivals += [(2.002, body, 2.006 if body is TRACTOR else 2.01)]
    pairs, _ = run(sorted(arrivals, key=lambda each: each[0]))
    assert sum(None not in pair for pair in pairs) == 20


def test_pairs_go_on_through_midnight() -> None:
    arrivals = [
        (0.2 * step + late, body, 86399.0 + 0.2 * step) for step in range(10) for late, body in enumerate_bodies()
    ]
    pairs, dropped = run(arrivals)
    assert len(pairs) == 10
    assert dropped == {}


def enumerate_bodies() -> list[tuple[float, Body]]:
    return [(0.0, TRACTOR), (0.02, TRAILER)]


def test_a_late_older_one_does_not_disturb_the_pair_that_is_coming() -> None:
    pairs, _ = run([(5.00, TRACTOR, 100.2), (5.01, TRAILER, 100.0), (5.02, TRAILER, 100.2)])
    assert pairs == [(None, 100.0), (100.2, 100.2)]


def test_sentences_pair_with_blocks_of_gps_time(report: object) -> None:
    pairing, pairs = Pairing(), []
    for body, encode in ((TRACTOR, nmea.sentences), (TRAILER, sbf.blocks)):
        stream = EpochStream(EpochSettings())
        stream.push(b"".join(encode(report())), 5.0)  # type: ignore[operator]
        for each in stream.poll(5.02):
            pairs += pairing.add(body, each, 5.02)
    assert len(pairs) == 1
    assert pairing.dropped == {}


@pytest.mark.parametrize(
    ("degrees", "is_enough"), [(1e-9, True), (1e-6 / 60.0, True), (1e-5 / 60.0, False), (1e-7, False), (1e-2, False)]
)
def test_positions_with_too_few_digits_are_said_to_have_them(degrees: float, is_enough: bool) -> None:
    said = resolution(replace(epoch(0.0), resolution=degrees))
    assert (said == "") is is_enough
    assert is_enough or ("at most 2 mm are allowed" in said and "at least 6 decimals of minutes" in said)


def test_an_epoch_without_position_has_no_digits_to_miss() -> None:
    assert resolution(Epoch(time=0.0, received=0.0, utc=0.0, resolution=1.0)) == ""
