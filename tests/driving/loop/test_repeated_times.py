"""A sample whose time is that of the one before: the controller goes on reporting what it knew before."""

import math

import pytest

from drawbar.config import load_configuration
from drawbar.driving.loop.controller import Controller
from drawbar.messages import ControllerState
from drawbar.signals import FixQuality, Measurement, Status
from drawbar.simulation import build_path

STILL = ("hitch_angle", "tractor_lateral_error", "trailer_heading_error", "lateral_deviation", "heading_deviation")


@pytest.fixture
def controller():
    """Return a controller after three samples of a vehicle on its line."""
    configuration = load_configuration("articulated", ["speed=1.0"])
    path, _ = build_path(configuration)
    controller = Controller(configuration, path, 0)
    for count in range(3):
        step(controller, count)
    return controller


def step(controller, count):
    """Return the controller's state after a sample: at 1 m/s along a straight."""
    x = 5.0 + 0.2 * count
    fixed = dict.fromkeys(("tractor_fix_quality", "trailer_fix_quality"), FixQuality.FIXED)
    measurement = Measurement(
        time=0.2 * count, tractor_x=x, tractor_y=0.02, trailer_x=x - 2.15, trailer_y=0.02, hitch_angle=0.01,
        speed=1.0, tractor_steering=0.0, trailer_steering=0.0, **fixed,
    )  # fmt: skip
    controller.feedback(measurement, 0)
    controller.prepare(late=False)
    return controller.state(0, correction_age=1.0, receiver_speed=1.0)


def known(state: ControllerState):
    """Return what a state says of the vehicle, and how many steps in a row were solved."""
    return [getattr(state, name) for name in STILL], state.solved


def test_a_repeated_time_leaves_what_is_known_of_the_vehicle(controller):
    before = known(controller.state(0, correction_age=1.0, receiver_speed=1.0))
    repeated = step(controller, 2)
    assert repeated.status == Status.TIME
    assert known(repeated) == before
    assert all(map(math.isfinite, before[0]))


def test_repeated_times_end_the_run_after_a_second(controller):
    statuses = [Status(step(controller, 2).status) for _ in range(5)]
    assert statuses == [Status.TIME] * 4 + [Status.STOPPED]
