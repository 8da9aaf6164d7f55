"""The receiver's stand-in: what it sends becomes the epoch that it was to report, in every protocol."""

import datetime
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from receiver_frames import nmea, sbf, ubx

from drawbar.errors import HardwareError
from drawbar.geometry import LocalFrame
from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.gnss.stream import EpochStream
from drawbar.signals import FixQuality

BEGIN = datetime.datetime(2026, 11, 22, tzinfo=datetime.UTC)
usual = settings(max_examples=150, deadline=None, derandomize=True)
angles = st.floats(-math.pi, math.pi)
inclinations = st.floats(-0.4, 0.4)
reports = st.builds(
    Report,
    time=st.integers(0, 7 * 86_400_000 - 1).map(lambda ms: BEGIN + datetime.timedelta(milliseconds=ms)),
    latitude=st.floats(-85.0, 85.0),
    longitude=st.floats(-180.0, 180.0),
    height=st.floats(-100.0, 4000.0),
    quality=st.sampled_from([each for each in FixQuality if each > FixQuality.NONE]),
    sigma_east=st.floats(0.01, 10.0),
    sigma_north=st.floats(0.01, 10.0),
    speed=st.floats(0.4, 15.0),
    course=angles,
    yaw=angles,
    roll=inclinations,
    pitch=inclinations,
    inertial_yaw=angles,
    yaw_rate=st.floats(-1.5, 1.5),
    heading_is_fixed=st.booleans(),
    baseline=st.floats(0.5, 2.5),
    correction_age=st.floats(0.1, 30.0),
    station=st.integers(0, 4095),
    satellites=st.integers(0, 40),
)


def epoch(frames: list[bytes]) -> Epoch:
    stream = EpochStream(EpochSettings(latency=0.0, sigma_inflation=1.0))
    (only,) = stream.push(b"".join(frames), 7.0) + stream.poll(7.02)
    assert {kind for kind in stream.dropped if kind != "heading not fixed"} == set()
    return only


def check_position(found: Epoch, report: Report, tolerance: float = 1e-3) -> None:
    frame = LocalFrame(latitude=report.latitude, longitude=report.longitude, height=report.height)
    assert math.hypot(*map(float, frame.east_north(found.latitude, found.longitude))) <= tolerance
    seconds = (report.time - report.time.replace(hour=0, minute=0, second=0, microsecond=0)).total_seconds()
    assert found.utc == pytest.approx(seconds, abs=1e-6)
    assert (found.quality, found.reported) == (report.quality, report.quality)
    assert (found.time, found.received) == (7.0, 7.0)
    assert found.satellites == report.satellites


def check_motion(found: Epoch, report: Report) -> None:
    assert found.speed == pytest.approx(report.speed, abs=2e-3)
    assert math.remainder(found.course - report.course, 2.0 * math.pi) == pytest.approx(0.0, abs=3e-3)


def check_yaw(found: Epoch, report: Report, tolerance: float) -> None:
    assert math.isfinite(found.yaw) is report.heading_is_fixed
    if report.heading_is_fixed:
        assert math.remainder(found.yaw - report.yaw, 2.0 * math.pi) == pytest.approx(0.0, abs=tolerance)


@usual
@given(reports)
def test_sentences_are_read_as_what_was_reported(report: Report) -> None:
    found = epoch(nmea.sentences(report))
    check_position(found, report)
    check_motion(found, report)
    check_yaw(found, report, 1e-5)
    assert found.height == pytest.approx(report.height, abs=1e-4)
    assert found.yaw_rate == pytest.approx(report.yaw_rate, abs=2e-6)
    assert (found.sigma_east, found.sigma_north) == pytest.approx((report.sigma_east, report.sigma_north), abs=1e-4)
    assert found.correction_age == pytest.approx(report.correction_age, abs=0.051)
    assert found.station == report.station
    assert found.day == report.time.date()
    if report.heading_is_fixed:
        assert (found.roll, found.pitch) == pytest.approx((report.roll, report.pitch), abs=1e-5)


@usual
@given(reports)
def test_blocks_are_read_as_what_was_reported(report: Report) -> None:
    found = epoch(sbf.blocks(report))
    check_position(found, report, 1e-6)
    check_motion(found, report)
    check_yaw(found, report, 1e-6)
    assert found.height == pytest.approx(report.height, abs=1e-9)
    assert (found.sigma_east, found.sigma_north) == pytest.approx((report.sigma_east, report.sigma_north), rel=1e-5)
    assert found.station == report.station
    if report.heading_is_fixed:
        assert (found.roll, found.pitch) == pytest.approx((report.roll, report.pitch), abs=1e-6)
        assert found.yaw_rate == pytest.approx(report.yaw_rate, abs=1e-6)


@usual
@given(reports)
def test_messages_of_u_blox(report: Report) -> None:
    found = epoch(ubx.frames(report))
    check_position(found, report)
    check_motion(found, report)
    check_yaw(found, report, 1e-6)
    assert found.height == pytest.approx(report.height, abs=1e-3)  # the library drops the tenths
    radius = math.hypot(report.sigma_east, report.sigma_north)
    assert found.sigma_east == pytest.approx(max(radius / math.sqrt(2.0), 0.01), abs=1e-3)
    assert found.day == report.time.date()
    assert found.resolution == 1e-9
    if report.heading_is_fixed:
        assert found.pitch == pytest.approx(report.pitch, abs=1e-3)
    if report.quality >= FixQuality.DIFFERENTIAL:
        assert (
            abs(found.correction_age - report.correction_age) <= 0.5 * report.correction_age + 0.5
        )  # middle of a class


@usual
@given(reports)
def test_sentences_of_boards_are_read_as_what_was_reported(report: Report) -> None:
    found = epoch([nmea.panda(report)])
    check_position(found, report)
    assert found.speed == pytest.approx(report.speed, abs=1e-4)
    assert (found.roll, found.pitch) == pytest.approx((report.roll, report.pitch), abs=9e-4)
    assert math.remainder(found.inertial_yaw - report.inertial_yaw, 2.0 * math.pi) == pytest.approx(0.0, abs=9e-4)
    assert math.isnan(found.yaw)
    sentence = nmea.paogi(report)
    assert bool(sentence) is report.heading_is_fixed
    if sentence:
        found = epoch([sentence])
        check_position(found, report)
        check_yaw(found, report, 1e-4)
        assert found.roll == pytest.approx(report.roll, abs=1e-4)


@usual
@given(reports)
def test_other_sentences_that_carry_an_attitude(report: Report) -> None:
    for encode in (nmea.hpr, nmea.avr):
        found = epoch([nmea.gga(report), encode(report)])
        check_yaw(found, report, 1e-5)
        if report.heading_is_fixed and abs(report.roll) > 1e-5 and abs(report.pitch) > 1e-5:
            assert (found.roll, found.pitch) == pytest.approx((report.roll, report.pitch), abs=1e-5)
    found = epoch([nmea.rmc(report), nmea.zda(report)])
    check_motion(found, report)
    assert found.day == report.time.date()
    assert found.quality is report.quality
    found = epoch([nmea.ksxt(report)])
    check_motion(found, report)
    check_yaw(found, report, 1e-5)
    for encode in (nmea.hdt, nmea.ths):
        found = epoch([nmea.gga(report), encode(report)])
        is_taken = report.quality is FixQuality.FIXED  # nothing else says whether the heading is
        assert math.isfinite(found.yaw) is is_taken


@pytest.mark.parametrize("encode", [nmea.sentences, ubx.frames, sbf.blocks, lambda report: [nmea.panda(report)]])
def test_a_lost_fix_is_an_epoch_without_position(encode: Callable[[Report], list[bytes]]) -> None:
    found = epoch(encode(Report(time=BEGIN, latitude=50.0, longitude=4.0, height=0.0, quality=FixQuality.NONE)))
    assert (found.quality, found.reported) == (FixQuality.NONE, FixQuality.NONE)
    assert np.isnan([found.latitude, found.longitude, found.sigma_east, found.sigma_north]).all()
    assert not found.has_fix


@pytest.mark.parametrize("encode", [nmea.sentences, ubx.frames, sbf.blocks])
def test_a_standing_receiver_has_no_course(encode: Callable[[Report], list[bytes]]) -> None:
    found = epoch(encode(Report(time=BEGIN, latitude=50.0, longitude=4.0, height=0.0, speed=0.01, course=1.0)))
    assert found.speed == pytest.approx(0.01, abs=1e-3)
    assert math.isnan(found.course)


def test_what_two_antennas_do_not_show_is_the_inertial_sensors() -> None:
    stream, found = EpochStream(EpochSettings(latency=0.0)), list[Epoch]()
    for index in range(3):
        report = Report(
            time=BEGIN + datetime.timedelta(seconds=0.2 * index),
            **{"latitude": 50.0, "longitude": 4.0, "height": 0.0, "yaw": 1.0, "pitch": 0.03, "roll": 0.05},
            inertial_yaw=-2.0 + 0.1 * index,
        )
        along = nmea.hrp(replace(report, roll=math.nan, pitch=0.02))  # antennas behind each other show no roll
        sent = [nmea.gga(report), along, nmea.panda(report)]
        found += stream.push(b"".join(sent), 7.0 + 0.2 * index) + stream.poll(7.02 + 0.2 * index)
    assert len(found) == 3
    for epoch in found:
        assert (epoch.yaw, epoch.pitch, epoch.roll) == pytest.approx((1.0, 0.02, 0.05), abs=1e-3)
    assert found[-1].yaw_rate == pytest.approx(0.5, abs=0.01)


def test_two_antennas_leave_one_axis_out() -> None:
    report = Report(time=BEGIN, latitude=50.0, longitude=4.0, height=0.0, yaw=1.0, pitch=0.1)
    for frames in (nmea.sentences(report), sbf.blocks(report), [nmea.gga(report), nmea.hpr(report)]):
        found = epoch(frames)
        assert found.pitch == pytest.approx(0.1, abs=1e-4)
        assert math.isnan(found.roll)


@pytest.mark.parametrize("change", [{"latitude": math.nan}, {"speed": math.inf}, {"quality": FixQuality.UNKNOWN}])
def test_what_no_receiver_reports_is_refused(change: dict[str, Any]) -> None:
    with pytest.raises(HardwareError, match=r"a receiver's stand-in was to report .*FixQuality\.NONE for a lost fix"):
        Report(**{"time": BEGIN, "latitude": 50.0, "longitude": 4.0, "height": 0.0} | change)


def test_a_place_of_the_frame_goes_over_the_wire_and_back() -> None:
    frame = LocalFrame(latitude=50.8642, longitude=4.6781)
    for east, north in ((0.0, 0.0), (123.456, -78.9), (-2000.0, 1500.0)):
        latitude, longitude = map(float, frame.level(east, north))
        report = Report(time=BEGIN, latitude=latitude, longitude=longitude, height=70.0)
        for frames in (nmea.sentences(report), ubx.frames(report), sbf.blocks(report)):
            found = epoch(frames)
            place = frame.east_north(found.latitude, found.longitude)
            assert math.hypot(float(place[0]) - east, float(place[1]) - north) <= 1e-3
