"""Hand steering of the stand-in's driver: along the line however long, round at its end, onto the line beside."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.driving.stand_in.hand_steering import HandSteering
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.path import Path
from drawbar.signals import Pose

STEP = 0.05
"""driven between two looks, m"""


@dataclass
class Bicycle:
    """What the hand looks at of a true state: a tractor that rolls without slip."""

    tractor: Pose
    tractor_steering: float = 0.0


@pytest.fixture
def vehicle():
    """Return the shipped vehicle."""
    return load_configuration("articulated").vehicle


def straight(length):
    """Return a line to the east."""
    x = np.linspace(0.0, length, 41)
    labels = np.zeros(40, np.int8)
    return Path.through(arc_length=x, x=x, y=0.0 * x, yaw=0.0 * x, label_of_piece=labels, label_names=("line",))


def driven(hand, vehicle, metres, x=0.0, y=0.0, yaw=0.0):
    """Return the states of a drive by hand."""
    state, states = Bicycle(Pose(x=x, y=y, yaw=yaw)), []
    for _ in range(round(metres / STEP)):
        wanted = hand(state)
        angle = state.tractor_steering if wanted is None else wanted
        pose = state.tractor
        turned = pose.yaw + STEP * math.tan(angle) / vehicle.wheelbase
        ahead = Pose(x=pose.x + STEP * math.cos(pose.yaw), y=pose.y + STEP * math.sin(pose.yaw), yaw=turned)
        state = Bicycle(ahead, angle)
        states.append(state)
    return states


def test_who_waits_long_before_engaging_is_still_on_the_line(vehicle):
    path = figure_eights([10.0, 8.0], 20.0)
    states = driven(HandSteering(path, vehicle), vehicle, 2.5 * path.length)
    away = [abs(path.project(each.tractor.x, each.tractor.y, 0.0, path.length)[1]) for each in states]
    assert max(away) < 0.4


def test_past_the_end_of_the_line_the_driver_turns_round_and_comes_back_on_it(vehicle):
    states = driven(HandSteering(straight(40.0), vehicle), vehicle, 80.0, x=30.0)
    assert max(each.tractor.x for each in states) < 40.0 + 12.0
    assert max(abs(each.tractor_steering) for each in states) < vehicle.tractor_steering_limit
    back = [each.tractor for each in states if 10.0 < each.tractor.x < 20.0]
    assert max(abs(pose.y) for pose in back) < 0.2
    assert max(abs(math.remainder(pose.yaw - math.pi, math.tau)) for pose in back) < 0.1


@pytest.mark.parametrize("offset", [3.0, -3.0])
def test_the_line_beside_is_taken_once_it_is_chosen(vehicle, offset):
    hand = HandSteering(straight(60.0), vehicle)
    hand.choose(offset)
    assert driven(hand, vehicle, 40.0)[-1].tractor.y == pytest.approx(offset, abs=0.1)


def test_a_line_that_curves_too_tightly_is_not_taken(vehicle):
    path = figure_eights([10.0], 20.0)
    hand = HandSteering(path, vehicle)
    hand.choose(12.0)
    assert abs(path.project(*_place(driven(hand, vehicle, 60.0)[-1]), 0.0, path.length)[1]) < 0.4


def _place(state):
    return state.tractor.x, state.tractor.y


def test_wheels_that_stand_nearly_right_are_left_alone(vehicle):
    hand = HandSteering(straight(40.0), vehicle)
    assert hand(Bicycle(Pose(x=5.0, y=0.02, yaw=0.0))) is None
