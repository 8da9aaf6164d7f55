"""Sensor line: the hitch angle by a table or by a polynomial, as the configuration has it."""

import pytest
from pydantic import ValidationError

from drawbar.machine.hardware.sensor_line import SensorBoardSettings
from drawbar.protocols.own_sentence import own_sentence

CUBIC = {"hitch_polynomial": (-1.2, 5e-4, 2e-8, 1e-12), "hitch_range": (100.0, 4000.0)}
TABLE = {"hitch_counts": (0.0, 1.0, 2.0, 3.0, 4.0), "hitch_angles": (-0.2, -0.1, 0.0, 0.1, 0.2)}


def hitch(counts):
    board = SensorBoardSettings(transport="file:x", **CUBIC).board()
    (report,) = board.push(own_sentence("PDBS", 1, counts, None), 0.0)
    return report.hitch_angle, dict(board.faults)


def test_an_inductive_sensor_measures_by_its_polynomial():
    angle, faults = hitch(3000)
    assert angle == pytest.approx(-1.2 + 3000 * (5e-4 + 3000 * (2e-8 + 3000 * 1e-12)))
    assert not faults


@pytest.mark.parametrize("counts", [99, 4001])
def test_counts_beyond_its_range_are_a_fault(counts):
    angle, faults = hitch(counts)
    assert angle != angle
    assert list(faults.values()) == [1]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"hitch_polynomial": CUBIC["hitch_polynomial"]}, "both hitch_polynomial and hitch_range"),
        ({"hitch_range": CUBIC["hitch_range"]}, "both hitch_polynomial and hitch_range"),
        (CUBIC | TABLE, "give either a table of the hitch angle"),
        (CUBIC | {"hitch_polynomial": (0.0, 1e-3, -1e-6, 0.0)}, "rises and falls"),
        (CUBIC | {"hitch_range": (4000.0, 100.0)}, "is empty; swap them"),
    ],
)
def test_what_is_no_sensor_is_refused(given, told):
    with pytest.raises(ValidationError, match=told):
        SensorBoardSettings(transport="file:x", **given)


@pytest.mark.parametrize(("given", "measured"), [(CUBIC, True), (TABLE, True), ({}, False)])
def test_it_is_known_whether_the_hitch_angle_is_measured(given, measured):
    assert SensorBoardSettings(transport="file:x", **given).measures_hitch is measured
