"""A drive that begins where no run can begin: the controller reports that, and begins once the vehicle is elsewhere."""

import math

import pytest
from fixes import fixes_of

from drawbar.config import load_configuration
from drawbar.driving.loop.control_loop import ControlLoop
from drawbar.driving.loop.controller import Controller
from drawbar.machine.hardware.sampler import Sampler
from drawbar.messages import ControllerState
from drawbar.signals import FixQuality, Status
from drawbar.simulation import build_path

LENGTH = 2.15
"""of the vehicle, from antenna to antenna, m"""


def epoch(count, x, y, yaw):
    """Return what both receivers say of a vehicle that stands straight."""
    instant = 10**9 + count * 200_000_000
    values = {"hitch_angle": math.nan} | dict.fromkeys(("tractor_deviation", "trailer_deviation"), 0.02)
    values |= {"epoch": instant, "time": instant + 50_000_000, "tractor_x": x, "tractor_y": y}
    values |= {"trailer_x": x - LENGTH * math.cos(yaw), "trailer_y": y - LENGTH * math.sin(yaw)}
    return fixes_of(**(values | dict.fromkeys(("tractor_quality", "trailer_quality"), int(FixQuality.FIXED))))


@pytest.fixture
def drive():
    """Return what takes epochs of a drive, and returns the newest state of its controller."""
    configuration = load_configuration("articulated", ["speed=1.0"])
    path, _ = build_path(configuration)
    states, now = [], [0]

    def send(message):
        if isinstance(message, ControllerState):
            states.append(message)

    loop = ControlLoop(
        Controller(configuration, path, 0),
        Sampler(configuration.sample_time),
        send=send,
        record=lambda record: None,
        clock=lambda: now[0],
    )

    def take(fixes):
        now[0] = fixes.time + 1_000_000
        loop.receive_fixes(fixes)
        return states[-1]

    return take


def test_a_vehicle_that_points_away_from_the_line_has_a_controller_too(drive):
    state = drive(epoch(0, 0.0, -1.5, -0.5 * math.pi))
    assert state.status == Status.GUIDANCE
    assert math.isnan(state.tractor_lateral_error)
    for count in range(1, 4):
        state = drive(epoch(count, 5.0, 0.1, 0.0))
    assert not Status(state.status).has_ended
    assert state.tractor_lateral_error == pytest.approx(0.1, abs=0.01)
