"""From the frames of an NMEA 2000 receiver to epochs, against its stand-in."""

import datetime
import math

import pytest

from drawbar.machine.stand_in.nmea2000 import nmea2000
from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.nmea2000.stream import Nmea2000Stream
from drawbar.signals import FixQuality

BEGIN = datetime.datetime(2026, 6, 1, 23, 59, 59, 400_000, tzinfo=datetime.UTC)
STEP = 0.2


def report(index: int, **changes: object) -> Report:
    values = {"latitude": 50.8712345678, "longitude": 4.7, "height": 61.5, "speed": 1.25, "course": 2.0, "station": 77}
    return Report(time=BEGIN + index * datetime.timedelta(seconds=STEP), **(values | changes))  # type: ignore[arg-type]


def epochs_of(reports: list[Report], stream: Nmea2000Stream, source: int = 32) -> list[Epoch]:
    encode, found = nmea2000(source), list[Epoch]()
    for index, each in enumerate(reports):
        for place, frame in enumerate(encode(each)):
            found += stream.push(frame, 10.0 + index * STEP + 0.001 * place)
        found += stream.poll(10.0 + index * STEP + 0.1)
    return found


def test_what_was_reported_comes_out_across_midnight() -> None:
    stream = Nmea2000Stream(EpochSettings(quality_hold=0.0))
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
