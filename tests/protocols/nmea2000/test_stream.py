"""From the frames of an NMEA 2000 receiver to epochs, against its stand-in."""

import datetime
import math
from typing import Any

import pytest

from drawbar.machine.stand_in.nmea2000 import nmea2000
from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.settings import AntennaSettings, EpochSettings
from drawbar.protocols.nmea2000.messages import decode_gnss_position
from drawbar.protocols.nmea2000.stream import Nmea2000Stream
from drawbar.signals import FixQuality
from drawbar.transports.base import CanFrame
from drawbar.transports.can_listener import packed

BEGIN = datetime.datetime(2026, 6, 1, 23, 59, 59, 400_000, tzinfo=datetime.UTC)
STEP = 0.2


def report(index: int, **changes: object) -> Report:
    values = {"latitude": 50.8712345678, "longitude": 4.7, "height": 61.5, "speed": 1.25, "course": 2.0, "station": 77}
    return Report(time=BEGIN + index * datetime.timedelta(seconds=STEP), **(values | changes))  # type: ignore[arg-type]


def epochs_of(reports: list[Report], stream: Nmea2000Stream, source: int = 32, *, line: float = 0.0) -> list[Epoch]:
    encode, found = nmea2000(source, line), list[Epoch]()
    for index, each in enumerate(reports):
        for place, frame in enumerate(encode(each)):
            found += stream.push(frame, 10.0 + index * STEP + 0.001 * place)
        found += stream.poll(10.0 + index * STEP + 0.1)
    return found


def test_what_was_reported_comes_out_across_midnight() -> None:
    stream = Nmea2000Stream(EpochSettings(latency=0.0, quality_hold=0.0))
    epochs = epochs_of([report(index) for index in range(6)], stream)
    assert len(epochs) == 6
    for index, epoch in enumerate(epochs):
        assert epoch.latitude == pytest.approx(50.8712345678, abs=1e-12)
        assert epoch.longitude == pytest.approx(4.7, abs=1e-12)
        assert (epoch.height, epoch.speed, epoch.station) == (61.5, 1.25, 77)
        assert epoch.course == pytest.approx(2.0, abs=1e-4)
        assert epoch.correction_age == 1.0
        assert epoch.quality is FixQuality.FIXED
        assert epoch.received == pytest.approx(10.0 + index * STEP)
        assert epoch.time == pytest.approx(10.0 + index * STEP)
        assert epoch.utc == pytest.approx((86399.4 + index * STEP) % 86400.0)
    assert epochs[-1].day == datetime.date(2026, 6, 2)
    assert math.isnan(epochs[0].yaw)
    assert not stream.dropped


def test_a_speed_that_no_vehicle_has_is_missing_and_counted() -> None:
    stream = Nmea2000Stream(EpochSettings())
    epochs = epochs_of([report(0, speed=49.0), report(1, speed=655.0)], stream)
    assert [epoch.speed for epoch in epochs] == pytest.approx([49.0, math.nan], nan_ok=True)
    assert stream.dropped == {"impossible speed": 1}


def test_a_second_that_no_day_has_is_no_time() -> None:
    body = bytearray(range(43))
    body[3:7], body[42] = (864_010_001).to_bytes(4, "little"), 0
    said = decode_gnss_position(bytes(body))
    assert said is not None
    assert math.isnan(said.utc)


def test_without_a_fix_there_is_no_position() -> None:
    stream = Nmea2000Stream(EpochSettings(quality_hold=0.0))
    lost = [report(0), report(1, quality=FixQuality.NONE), report(2, quality=FixQuality.FLOAT)]
    assert [epoch.quality for epoch in epochs_of(lost, stream)] == [
        FixQuality.FIXED,
        FixQuality.NONE,
        FixQuality.FLOAT,
    ]


def test_another_receiver_and_garbage_are_counted_and_left_out() -> None:
    stream = Nmea2000Stream(EpochSettings(), source=32)
    assert epochs_of([report(0)], stream, source=33) == []
    assert stream.push(b"\x01\x02", 10.0) == []
    assert stream.push(bytes(13), 10.0) == []
    assert stream.dropped["no frame"] == 2
    assert stream.dropped["other receiver"] > 0
    assert len(epochs_of([report(1)], stream)) == 1


@pytest.mark.parametrize(
    ("rate", "expected"),
    [
        ("002ccfff", 0.1),  # -3200000: to the left
        ("00d43000", -0.1),
        ("ffffff7f", math.nan),  # not available
        ("fe5b5303", math.radians(-99.9)),
        ("53105503", math.nan),  # 100.1 °/s
    ],
)
def test_a_rate_of_turn_is_given_to_the_right_in_steps_of_a_32nd_of_a_microradian(rate: str, expected: float) -> None:
    stream = Nmea2000Stream(EpochSettings())
    position = nmea2000(32)(report(0))[:-1]
    turn = packed(CanFrame(0x09F11320, bytes.fromhex(f"00{rate}ffffff")))
    for frame in (*position, turn):
        stream.push(frame, 10.0)
    (epoch,) = stream.poll(10.1)
    assert epoch.yaw_rate == pytest.approx(expected, abs=2e-8, nan_ok=True)
    assert epoch.attitude_age == 0.0
    assert stream.dropped["impossible yaw rate"] == (rate == "53105503")


@pytest.mark.parametrize("line", [0.0, 0.5 * math.pi, -1.0])
def test_the_heading_of_two_antennas_is_the_bodys_yaw_and_roll_stays_the_inertial_sensors(line: float) -> None:
    antennas = AntennaSettings(baseline=1.2, line=line)
    stream = Nmea2000Stream(EpochSettings(antennas=antennas))
    told = [report(index, yaw=2.5, roll=0.05, pitch=-0.02, yaw_rate=0.1) for index in range(3)]
    for epoch in epochs_of(told, stream, line=line):
        assert (epoch.yaw, epoch.roll, epoch.pitch) == pytest.approx((2.5, 0.05, -0.02), abs=1e-4)
    assert not stream.dropped


def test_a_heading_may_be_a_compasss_where_two_antennas_are_not_stated() -> None:
    epochs = epochs_of([report(index, yaw=2.5) for index in range(2)], Nmea2000Stream(EpochSettings()))
    assert all(math.isnan(epoch.yaw) for epoch in epochs)


@pytest.mark.parametrize(("changes", "kind"), [({"heading_is_fixed": False}, None), ({"quality": FixQuality.FLOAT}, 1)])
def test_a_heading_goes_by_the_fix(changes: dict[str, Any], kind: int | None) -> None:
    stream = Nmea2000Stream(EpochSettings(antennas=AntennaSettings(baseline=1.2)))
    (epoch,) = epochs_of([report(0, yaw=2.5, **changes)], stream)
    assert math.isnan(epoch.yaw)
    assert stream.dropped.get("heading not fixed") == kind


def test_an_inertial_sensor_comes_with_the_epoch() -> None:
    stream = Nmea2000Stream(EpochSettings())
    told = [report(index, roll=0.05, pitch=-0.02, yaw_rate=0.1) for index in range(3)]
    for epoch in epochs_of(told, stream):
        assert (epoch.roll, epoch.pitch, epoch.yaw_rate) == pytest.approx((0.05, -0.02, 0.1), abs=5e-5)
    assert not stream.dropped
