"""Yaw rate: unit and sign of what sentences and blocks say of it, and what the yaw of an inertial sensor tells."""

import math
import struct
from collections.abc import Callable

import pytest
from receiver_frames import nmea, sbf

from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.checksums import crc_ccitt
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.gnss.stream import EpochStream

Maker = Callable[..., Report]
Once = Callable[..., Epoch]
LEFT = 0.1
"""rad/s: 5.7296 °/s"""


@pytest.mark.parametrize(
    ("sentence", "rate"),
    [
        ("GNROT,-343.77,A", LEFT),  # the bow turns to port
        ("HEROT,343.77,A", -LEFT),
        ("GNROT,-5999.9,A", math.radians(5999.9 / 60.0)),
        ("GNROT,-6000.1,A", math.nan),
        ("GNROT,-343.77,V", math.nan),
        ("GNROT,,A", math.nan),
    ],
)
def test_a_rate_of_turn_is_given_in_degrees_per_minute_to_the_right(
    report: Maker, once: Once, sentence: str, rate: float
) -> None:
    epoch = once(nmea.gga(report()) + nmea.sentence(sentence))
    assert epoch.yaw_rate == pytest.approx(rate, abs=1e-5, nan_ok=True)
    assert epoch.attitude_age == 0.0


def with_rate(block: bytes, degrees: float) -> bytes:
    """Return an AttEuler with another rate of the heading, degrees per second to the right."""
    tail = block[4:40] + struct.pack("<f", degrees) + block[44:]
    return block[:2] + struct.pack("<H", crc_ccitt(tail)) + tail


@pytest.mark.parametrize(
    ("degrees", "rate"), [(-math.degrees(LEFT), LEFT), (5.0, -math.radians(5.0)), (-100.1, math.nan), (-2e10, math.nan)]
)
def test_septentrio_gives_the_rate_of_the_heading(report: Maker, once: Once, degrees: float, rate: float) -> None:
    block = sbf.att_euler(report(yaw=1.0, pitch=0.1))
    assert len(block) == 44
    epoch = once(sbf.pvt_geodetic(report()) + with_rate(block, degrees))
    assert epoch.yaw_rate == pytest.approx(rate, nan_ok=True)
    assert epoch.yaw == pytest.approx(1.0)


def test_the_rate_of_a_heading_that_floats_is_not_taken(report: Maker, once: Once) -> None:
    for changes in ({"heading_is_fixed": False}, {"yaw": math.nan}):
        told = report(**{"yaw": 1.0, "pitch": 0.1, "yaw_rate": LEFT} | changes)
        assert math.isnan(once(sbf.pvt_geodetic(told) + sbf.att_euler(told)).yaw_rate)


def test_what_is_impossible_is_counted(report: Maker) -> None:
    stream = EpochStream(EpochSettings())
    stream.push(nmea.gga(report()) + nmea.sentence("GNROT,9000.0,A"), 1.0)
    stream.poll(2.0)
    assert stream.dropped == {"impossible yaw rate": 1}


def panda(tenths: int | str, clock: float, *, rest: str = "-23,12,5") -> bytes:
    place = "5052.6123456,N,00442.1234567,E,4,17,0.70,42.318,1.2,1.944"
    return nmea.sentence(f"PANDA,{101530.0 + clock:09.2f},{place},{tenths},{rest}")


def driven(*sentences: bytes) -> list[Epoch]:
    stream, epochs = EpochStream(EpochSettings()), list[Epoch]()
    for number, data in enumerate(sentences):
        epochs += stream.push(data, 5.0 + 0.2 * number)
        epochs += stream.poll(5.1 + 0.2 * number)
    return epochs


@pytest.mark.parametrize(
    ("before", "after", "degrees"),
    [(1235, 1229, 3.0), (1229, 1235, -3.0), (3, 3597, 3.0), (2703, 2697, 3.0), (1235, 1235, 0.0)],
)
def test_a_board_turns_as_the_yaw_of_its_sensor_changes(before: int, after: int, degrees: float) -> None:
    first, second = driven(panda(before, 0.0), panda(after, 0.2))
    assert math.isnan(first.yaw_rate)
    assert first.attitude_age == 0.0
    assert second.yaw_rate == pytest.approx(math.radians(degrees))
    assert second.attitude_age == pytest.approx(0.1)


def test_what_a_board_calls_yaw_rate_is_not_taken() -> None:
    for told in ("-23,12,0", "-23,12,900", "-23,12,"):
        assert driven(panda(1235, 0.0), panda(1229, 0.2, rest=told))[1].yaw_rate == pytest.approx(math.radians(3.0))


@pytest.mark.parametrize(
    "sentences",
    [
        (panda(1235, 0.0), panda(1229, 0.4)),  # an epoch is missing
        (panda(1235, 0.0), panda(65535, 0.2, rest=",,")),
        (panda(65535, 0.0, rest=",,"), panda(1229, 0.2)),
        (panda(1235, 0.0), panda(1031, 0.2)),  # 20.4° in 0.2 s: its zero has moved
    ],
)
def test_without_two_yaws_in_a_row_nothing_is_known(sentences: tuple[bytes, bytes]) -> None:
    (*_, last) = driven(*sentences)
    assert math.isnan(last.yaw_rate)
    assert last.attitude_age == 0.0


def test_a_frozen_board_tells_nothing_and_afterwards_it_turns_from_its_next_yaw_on() -> None:
    begin, frozen = panda(1235, 0.0), panda(1229, 0.2)
    epochs = driven(begin, frozen, frozen, frozen, panda(1100, 0.8), panda(1094, 1.0))
    rates = [epoch.yaw_rate for epoch in epochs]
    assert rates == pytest.approx([math.nan, math.radians(3.0), math.nan, math.radians(3.0)], nan_ok=True)
