"""Which line is driven, and in which direction."""

from dataclasses import replace

import numpy as np
import pytest
from ordinary import measured

from drawbar.config import load_configuration
from drawbar.driving.loop.driven_line import DrivenLine
from drawbar.errors import PathError
from drawbar.guidance.figure_eight import figure_eights


def straight(*changes):
    configuration = load_configuration("articulated", list(changes))
    return DrivenLine.first(configuration, figure_eights((8.0,), 40.0))


def seen(path, at, left, *, backwards):
    """Return antennas of a vehicle beside a path."""
    x, y, yaw, _ = path.sample(np.array([at]))[0]
    ahead = np.array([np.cos(yaw), np.sin(yaw)]) * (-4.0 if backwards else 4.0)
    tractor = np.array([x, y]) + left * np.array([-np.sin(yaw), np.cos(yaw)])
    (tx, ty), (rx, ry) = tractor, tractor - ahead
    return measured(tx, ty, rx, ry)


def test_a_parallel_line_is_driven_as_the_vehicle_faces():
    line = straight("path.working_width=3.0").beside(3.0)
    place = line.path.sample(np.array([20.0]))[0]
    turned, progress = line.nearest(seen(line.path, 20.0, 0.1, backwards=True))
    assert turned.against
    assert turned.offset == 3.0
    assert turned.path.sample(np.array([progress]))[0, :2] == pytest.approx(place[:2], abs=1e-6)
    assert np.cos(turned.path.sample(np.array([progress]))[0, 2] - place[2]) == pytest.approx(-1.0)
    assert turned.nearest(seen(line.path, 20.0, 0.1, backwards=True))[0] == turned
    assert turned.beside(5.0).against
    back, _ = turned.nearest(seen(line.path, 20.0, 0.1, backwards=False))
    assert not back.against


def test_a_single_line_is_not_turned_round():
    line = straight()
    assert line.nearest(seen(line.path, 20.0, 0.0, backwards=True)) == (line, pytest.approx(20.0))


def test_without_an_antenna_the_direction_stays():
    line = straight("path.working_width=3.0")
    measurement = replace(seen(line.path, 20.0, 0.0, backwards=True), trailer_x=np.nan)
    assert line.nearest(measurement)[0] is line


def test_the_tractors_yaw_is_enough_to_know_the_direction():
    line = straight("path.working_width=3.0")
    measurement = replace(seen(line.path, 20.0, 0.0, backwards=True), trailer_x=np.nan)
    ahead = float(line.path.sample(np.array([20.0]))[0, 2])
    assert line.nearest(replace(measurement, tractor_yaw=ahead))[0] is line
    assert line.nearest(replace(measurement, tractor_yaw=ahead + np.pi))[0].against


def test_a_line_that_the_vehicle_cannot_drive_is_refused():
    with pytest.raises(PathError, match="tightest curve"):
        straight().beside(6.5)


def test_a_nudge_stays_on_its_side_of_the_field_whichever_way_the_line_is_driven():
    line = straight("path.working_width=3.0").beside(3.0).nudged(0.2)
    turned, _ = line.nearest(seen(line.path, 20.0, 0.1, backwards=True))
    assert (line.left, turned.left) == (0.2, -0.2)
    assert (turned.offset, turned.nudge) == (3.0, 0.2)
    assert turned.nudged(-0.1).left == 0.1


def test_another_line_has_no_nudge_of_the_one_before():
    assert straight("path.working_width=3.0").nudged(0.2).beside(3.0).nudge == 0.0


def test_a_nudge_that_the_vehicle_cannot_drive_is_refused():
    line = straight().beside(4.0)
    with pytest.raises(PathError, match="tightest curve"):
        line.nudged(2.5)
