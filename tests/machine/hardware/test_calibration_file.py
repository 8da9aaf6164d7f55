"""A calibration in a TOML file: written, read, replaced, and nothing else touched."""

import tomllib
from dataclasses import replace
from datetime import date

import pytest

from drawbar.errors import ConfigurationError
from drawbar.machine.hardware.calibrated import Calibrated
from drawbar.machine.hardware.calibration_file import calibration_section, read_sensor, updated
from drawbar.protocols.sensors import InductiveSensor, Potentiometer

BAND = Calibrated(
    value=0.15, deviation=0.004, residual=0.001, samples=3, unit="of the full drive", residual_unit="of the full drive"
)
TABLE = Potentiometer(counts=(1.0, 2.0, 3.0, 4.0, 5.0), angles=(-2.0, -1.0, 0.0, 1.0, 2.0), deviation=0.01)
CUBIC = InductiveSensor(coefficients=(-0.6, 0.2, 0.0, 0.0), lowest=0.0, highest=5.0)
DAY = date(2026, 11, 22)
TEXT = """\
# my tractor
name = "mine"

[vehicle]
wheelbase = 1.7  # measured
"""


@pytest.mark.parametrize("sensor", [TABLE, CUBIC])
def test_what_is_written_is_read_again(sensor: Potentiometer | InductiveSensor) -> None:
    section = calibration_section("front_wheels", DAY, {"dead_band_left": BAND}, sensor)
    text = updated(TEXT, "front_wheels", section)
    assert text.startswith(TEXT)
    read = tomllib.loads(text)["calibration"]["front_wheels"]
    assert read["date"] == DAY
    assert read["dead_band_left"] == {
        "value": 0.15,
        "deviation": 0.004,
        "residual": 0.001,
        "samples": 3,
        "unit": "of the full drive",
        "residual_unit": "of the full drive",
    }
    assert read_sensor(read) == sensor


def test_another_calibration_replaces_its_own_section_and_no_other() -> None:
    first = updated(TEXT, "front_wheels", calibration_section("front_wheels", DAY, {"dead_band_left": BAND}, TABLE))
    both = updated(first, "joint", calibration_section("joint", DAY, {"dead_band_left": BAND})) + "[later]\nx = 1\n"
    again = calibration_section("front_wheels", date(2027, 1, 1), {"dead_band_left": replace(BAND, value=0.2)})
    text = updated(both, "front_wheels", again)
    read = tomllib.loads(text)
    assert read["calibration"]["front_wheels"]["dead_band_left"]["value"] == 0.2
    assert "sensor" not in read["calibration"]["front_wheels"]
    assert read["calibration"]["joint"]["date"] == DAY
    assert read["later"] == {"x": 1}
    assert text.startswith(TEXT)
    assert text.count("[calibration.front_wheels]") == 1
    assert updated(text, "front_wheels", again) == text


def test_what_is_refused_is_not_written() -> None:
    refused = replace(BAND, refusals=("2 runs moved; make 3",))
    with pytest.raises(ConfigurationError, match="dead_band_left: 2 runs moved"):
        calibration_section("front_wheels", DAY, {"dead_band_left": refused})
    with pytest.raises(ConfigurationError, match="small letters"):
        calibration_section("front.wheels", DAY, {})


@pytest.mark.parametrize(
    "text", ["calibration = {front_wheels = {date = 1}}\n", "[calibration]\nfront_wheels.date = 1\n", "x = \n"]
)
def test_a_file_that_cannot_be_changed_safely_is_refused(text: str) -> None:
    with pytest.raises(ConfigurationError):
        updated(text, "front_wheels", calibration_section("front_wheels", DAY, {"dead_band_left": BAND}))


def test_a_section_without_a_sensor_is_refused() -> None:
    for given in ({}, {"sensor": 3}, {"sensor": {"counts": [1.0]}}):
        with pytest.raises(ConfigurationError, match="calibrate the sensor"):
            read_sensor(given)
