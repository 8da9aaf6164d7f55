"""Attitude: headings are taken while fixed, from antennas as far apart as surveyed, and turned onto the body."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from receiver_frames import nmea, sbf, ubx

from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.settings import AntennaSettings, EpochSettings
from drawbar.protocols.gnss.stream import EpochStream
from drawbar.signals import FixQuality

Maker = Callable[..., Report]
Once = Callable[..., Epoch]


@pytest.mark.parametrize("encode", [nmea.hrp, nmea.hpr, nmea.avr, nmea.ksxt, ubx.relposned, sbf.att_euler])
def test_a_heading_that_floats_is_not_taken(report: Maker, once: Once, encode: Callable[[Report], bytes]) -> None:
    fixed = report(yaw=1.0, pitch=0.1, quality=FixQuality.FLOAT)  # the position's quality does not matter
    assert once(nmea.gga(fixed) + encode(fixed)).yaw == pytest.approx(1.0, abs=1e-4)
    floating = replace(fixed, heading_is_fixed=False)
    epoch = once(nmea.gga(floating) + encode(floating))
    assert all(math.isnan(each) for each in (epoch.yaw, epoch.roll, epoch.pitch))
    assert epoch.has_fix


def test_headings_that_are_not_taken_are_counted(report: Maker) -> None:
    stream = EpochStream(EpochSettings(antennas=AntennaSettings(baseline=1.05)))
    stream.push(ubx.relposned(report(yaw=1.0, heading_is_fixed=False)), 1.0)
    stream.poll(2.0)
    stream.push(ubx.relposned(report(1.0, yaw=1.0, baseline=1.0)), 3.0)
    stream.poll(4.0)
    assert stream.dropped == {"heading not fixed": 1, "heading with a wrong distance of antennas": 1}


@pytest.mark.parametrize("sentence", ["GNHDT,123.456,T", "GNTHS,123.456,A"])
def test_a_heading_without_quality_goes_by_the_position(report: Maker, once: Once, sentence: str) -> None:
    for quality in (FixQuality.FIXED, FixQuality.FLOAT):
        epoch = once(nmea.gga(report(quality=quality)) + nmea.sentence(sentence))
        assert math.isfinite(epoch.yaw) is (quality is FixQuality.FIXED)


@pytest.mark.parametrize("mode", ["E", "M", "S", "V"])
def test_a_heading_that_is_not_measured_is_not_taken(report: Maker, once: Once, mode: str) -> None:
    assert math.isnan(once(nmea.gga(report()) + nmea.sentence(f"GNTHS,123.456,{mode}")).yaw)


@pytest.mark.parametrize(("measured", "is_taken"), [(1.0, True), (1.029, True), (0.971, True), (1.031, False)])
@pytest.mark.parametrize("encode", [ubx.relposned, nmea.avr])
def test_the_distance_of_the_antennas_must_be_the_surveyed_one(
    report: Maker, once: Once, measured: float, is_taken: bool, encode: Callable[[Report], bytes]
) -> None:
    settings: dict[str, Any] = {"antennas": AntennaSettings(baseline=1.0)}
    epoch = once(encode(report(yaw=1.0, pitch=0.0, baseline=measured)), **settings)
    assert math.isfinite(epoch.yaw) is is_taken


def test_a_vector_to_a_base_that_stands_is_no_heading(report: Maker, once: Once) -> None:
    data = bytearray(ubx.relposned(report(yaw=1.0)))
    data[6 + 60] &= ~(1 << 5) & 0xFF  # not moving
    epoch = once(nmea.gga(report()) + ubx.frame(0x01, 0x3C, bytes(data[6:-2])))
    assert math.isnan(epoch.yaw)


@pytest.mark.parametrize(
    ("line", "yaw", "roll", "pitch"),
    [
        (0.0, 1.0, math.nan, 0.1),
        (math.pi / 2.0, 1.0 - math.pi / 2.0, -0.1, math.nan),  # to the left, which is up: right side up
        (-math.pi / 2.0, 1.0 + math.pi / 2.0, 0.1, math.nan),
        (math.pi, 1.0 - math.pi, math.nan, -0.1),
        (0.8, 0.2, math.nan, math.nan),
    ],
)
def test_the_line_of_the_antennas_is_turned_onto_the_body(
    report: Maker, once: Once, line: float, yaw: float, roll: float, pitch: float
) -> None:
    antennas = AntennaSettings(line=line)
    epoch = once(ubx.relposned(report(yaw=1.0, pitch=0.1)), antennas=antennas)  # its end is lower than its beginning
    assert epoch.yaw == pytest.approx(yaw, abs=1e-6)
    assert (epoch.roll, epoch.pitch) == pytest.approx((roll, pitch), abs=1e-3, nan_ok=True)


def test_a_plane_of_antennas_is_turned_as_a_whole(report: Maker, once: Once) -> None:
    epoch = once(nmea.hrp(report(yaw=1.0, roll=0.03, pitch=-0.02)), antennas=AntennaSettings(line=math.pi / 2.0))
    assert (epoch.roll, epoch.pitch) == pytest.approx((0.02, 0.03), abs=1e-5)


def test_the_yaw_of_an_inertial_sensor_is_not_a_heading(report: Maker, once: Once) -> None:
    epoch = once(nmea.panda(report(inertial_yaw=1.0, roll=0.1, pitch=0.05)))
    assert math.isnan(epoch.yaw)
    assert (epoch.inertial_yaw, epoch.roll, epoch.pitch) == pytest.approx((1.0, 0.1, 0.05), abs=1e-3)
    without = once(nmea.panda(report()))
    assert all(math.isnan(each) for each in (without.inertial_yaw, without.roll, without.pitch))
