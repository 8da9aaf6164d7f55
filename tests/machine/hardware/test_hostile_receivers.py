"""Two receivers on hostile lines, from bytes to what the drive is told: sane, paired by their own times, in order.

A short run from fixed seeds; DRAWBAR_FUZZ_LINES=1000 makes it so many pairs of lines.
"""

import math
import os
import random
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import pytest
from receiver_frames import nmea, sbf, ubx
from receiver_lines import (
    BEGINS,
    CLEAN,
    DIALECTS,
    LATITUDE,
    LONGITUDE,
    MISHAPS,
    STEP,
    TURN,
    Burst,
    delay,
    line,
    lose,
    set_clock,
    shuffle,
    truth,
)

from drawbar.driving.stand_in.memory_transports import MemoryTransport
from drawbar.geometry import LocalFrame
from drawbar.machine.hardware.navigation import Navigation
from drawbar.machine.hardware.receiver import Receiver, ReceiverSettings
from drawbar.machine.hardware.sampler import Sampler
from drawbar.messages import Fixes
from drawbar.messages.records import decode, encode
from drawbar.signals import FixQuality

LINES = int(os.environ.get("DRAWBAR_FUZZ_LINES", "10"))
FRAME = LocalFrame(latitude=LATITUDE, longitude=LONGITUDE)
METRES = float(FRAME.east_north(LATITUDE, LONGITUDE + STEP)[0])
"""from an epoch to the next"""


def told(*lines: Sequence[Burst]) -> list[Fixes]:
    """Return what receivers' process tells the controller of the tractor's line and the trailer's, through a record."""
    transports = [MemoryTransport() for _ in lines]
    settings = ReceiverSettings(transport="file:memory")
    navigation = Navigation([Receiver(each, settings) for each in transports], FRAME)
    arrivals = [
        (burst.time, transport, burst) for each, transport in zip(lines, transports, strict=True) for burst in each
    ]
    found = list[Fixes]()
    for time, transport, burst in sorted(arrivals, key=lambda arrival: arrival[0]):
        while (due := navigation.due) <= time:
            found += navigation.poll(due)
        transport.arrive(time, b"".join(burst.frames))
        found += navigation.poll(time)
    while (due := navigation.due) < math.inf:
        found += navigation.poll(due)
    received = [decode(encode(fixes), Fixes) for fixes in found]
    assert all(isinstance(fixes, Fixes) for fixes in received), "the controller refuses a record"
    return [fixes for fixes in received if isinstance(fixes, Fixes)]


def assert_sane(fixes: Fixes) -> None:
    """Assert that the drive is told nothing that no receiver can have measured."""
    for report in (fixes.tractor, fixes.trailer):
        known = math.isfinite(report.x)
        assert math.isfinite(report.y) == known
        assert not known or (math.hypot(report.x, report.y) < 1.3e7 and 0.01 <= report.deviation < 2e6)
        assert known == (report.quality != FixQuality.NONE) or report.quality in (0, 1)
        assert math.isnan(report.speed) or 0.0 <= report.speed <= 50.0
        assert math.isnan(report.correction_age) or 0.0 <= report.correction_age <= 3600.0
        assert math.isnan(report.yaw_rate) or abs(report.yaw_rate) < 1.75
        assert math.isnan(report.yaw) or abs(report.yaw) <= math.pi
        assert 0 <= report.attitude_time <= fixes.time
    assert 0 < fixes.epoch <= fixes.first_byte <= fixes.time
    assert fixes.time - fixes.first_byte < 2e9


def index_of(x: float) -> int:
    """Return the epoch that a place tells of."""
    return round(x / METRES)


def assert_of_one_instant(fixes: Fixes) -> None:
    """Assert that both places, where both are there, and the heading are of one epoch."""
    assert not abs(fixes.tractor.x - fixes.trailer.x) > METRES / 2.0
    if math.isfinite(fixes.tractor.x + fixes.tractor.yaw):
        assert fixes.tractor.yaw == pytest.approx(TURN * (index_of(fixes.tractor.x) - 60), abs=TURN / 2.0)


@pytest.mark.parametrize("seed", range(LINES))
def test_two_hostile_receivers_end_no_drive_and_are_paired_again_afterwards(seed: int) -> None:
    chance = random.Random(seed)
    begin, mishaps = chance.choice(BEGINS), [each for each in MISHAPS if each is not set_clock]
    dialects = [chance.choice(list(DIALECTS)) for _ in range(2)]
    lines = [line(DIALECTS[dialect], chance, begin=begin, mishaps=mishaps) for dialect in dialects]
    found, sampler = told(*lines), Sampler(0.2)
    samples = [measured for measured in map(sampler.take, found) if measured is not None]
    for fixes in found:
        assert_sane(fixes)
    assert all(after.sequence == before.sequence + 1 and after.time >= before.time for before, after in pairwise(found))
    assert all(after.time > before.time for before, after in pairwise(samples))
    tail = [fixes for fixes in found if fixes.time > (112.0 - 0.2 * (CLEAN - 9)) * 1e9]
    assert len(tail) == 15
    for fixes in tail:
        assert (fixes.tractor.heard, fixes.trailer.heard) == (1, 1)
        assert_of_one_instant(fixes)
    assert all(after.epoch > before.epoch for before, after in pairwise(tail))


@pytest.mark.parametrize("seed", range(LINES))
def test_epochs_that_are_late_or_lost_or_in_disorder_are_paired_by_their_own_times(seed: int) -> None:
    chance = random.Random(seed)
    begin, timed = chance.choice(BEGINS), [name for name in DIALECTS if not {"HDT", "THS"} & set(name.split())]
    lines = [
        line(DIALECTS[chance.choice(timed)], chance, begin=begin, mishaps=(delay, lose, shuffle), share=0.7)
        for _ in range(2)
    ]
    found = told(*lines)
    assert any(math.isfinite(fixes.tractor.x + fixes.trailer.x) for fixes in found)
    for fixes in found:
        assert_sane(fixes)
        assert_of_one_instant(fixes)


HEADINGS = {"HRP": nmea.hrp, "HPR": nmea.hpr, "AVR": nmea.avr, "AttEuler": sbf.att_euler, "RELPOSNED": ubx.relposned}
"""frames of a heading that carry a time"""


@pytest.mark.parametrize("name", HEADINGS)
@pytest.mark.parametrize("latest", [0.015, 0.1, 0.3, 1.0])
def test_a_heading_that_comes_late_is_that_of_its_own_epoch_or_none(name: str, latest: float) -> None:
    chance = random.Random(f"{name} {latest}")
    bursts = line(lambda report: [nmea.gga(report)], chance, begin=BEGINS[1], mishaps=MISHAPS, share=0.0)
    late = [
        Burst(burst.index, burst.time + chance.uniform(0.0, latest), [HEADINGS[name](truth(burst.index, BEGINS[1]))])
        for burst in bursts
    ]
    found = told(sorted(bursts + late, key=lambda burst: burst.time))
    assert [index_of(fixes.tractor.x) for fixes in found if math.isfinite(fixes.tractor.x)] == list(range(60))
    for fixes in found:
        assert_sane(fixes)
        assert_of_one_instant(fixes)
    headings = sum(math.isfinite(fixes.tractor.yaw) for fixes in found)
    assert headings >= (50 if latest < 0.02 else 0)


@pytest.mark.parametrize("name", HEADINGS)
@pytest.mark.parametrize("off", [-1, 1, 7, -40_000])
def test_a_heading_with_the_time_of_another_epoch_is_none_of_this_one(name: str, off: int) -> None:
    bursts = line(lambda report: [nmea.gga(report)], random.Random(0), begin=BEGINS[0], mishaps=MISHAPS, share=0.0)
    for burst in bursts:
        report = replace(truth(burst.index, BEGINS[0]), time=truth(burst.index + off, BEGINS[0]).time)
        burst.frames.append(HEADINGS[name](report))
    found = told(bursts)
    assert not any(math.isfinite(fixes.tractor.yaw) and math.isfinite(fixes.tractor.x) for fixes in found)
    for fixes in found:
        assert_sane(fixes)
