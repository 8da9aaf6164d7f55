"""The heading of a vehicle that has not rolled yet: known only by what measures it."""

import math

import pytest

from drawbar.config import load_configuration
from drawbar.driving.loop.controller import Controller
from drawbar.signals import FixQuality, Measurement
from drawbar.simulation import build_path


def heading_deviation(speeds, **measured):
    """Return the controller's standard deviation of the heading after samples on a straight, at speeds in m/s."""
    configuration = load_configuration("articulated", ["speed=1.0"])
    path, _ = build_path(configuration)
    controller, x = Controller(configuration, path, 0), 5.0
    fixed = dict.fromkeys(("tractor_fix_quality", "trailer_fix_quality"), FixQuality.FIXED)
    deviations = dict.fromkeys(("tractor_fix_deviation", "trailer_fix_deviation"), 0.01)
    for count, speed in enumerate(speeds):
        x += 0.2 * speed
        measurement = Measurement(
            time=0.2 * count, tractor_x=x, tractor_y=0.0, trailer_x=x - 2.34, trailer_y=0.0, speed=speed,
            tractor_steering=0.0, trailer_steering=0.0, **{"hitch_angle": math.nan} | fixed | deviations | measured,
        )  # fmt: skip
        controller.feedback(measurement, 0)
        controller.prepare(late=False)
    return controller.state(0, correction_age=1.0, receiver_speed=1.0).heading_deviation


def test_a_standing_vehicle_whose_antennas_alone_are_measured_has_no_heading():
    """Their distance shows the hitch angle only as far as the lengths are exact, and they never are."""
    assert math.isnan(heading_deviation(200 * [0.02]))


@pytest.mark.parametrize("measured", [{"hitch_angle": 0.0}, {"tractor_yaw": 0.0}])
def test_one_whose_hitch_angle_or_yaw_is_measured_has_one(measured):
    assert heading_deviation(50 * [0.02], **measured) < 0.05


def test_two_metres_show_it():
    assert math.isnan(heading_deviation(8 * [1.0]))
    assert heading_deviation(12 * [1.0]) < 0.1
