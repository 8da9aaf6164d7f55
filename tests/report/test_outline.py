import math

import numpy as np
import pytest

from drawbar.report.outline import tractor_outline, trailer_outline
from drawbar.signals import Pose
from drawbar.vehicle.parameters import VehicleParameters

VEHICLE = VehicleParameters()
HOME = Pose(x=0.0, y=0.0, yaw=0.0)
AWAY = Pose(x=100.0, y=-40.0, yaw=2.0)


def moved(points, pose):
    e = np.array([math.cos(pose.yaw), math.sin(pose.yaw)])
    n = np.array([-math.sin(pose.yaw), math.cos(pose.yaw)])
    return points[:, :1] * e + points[:, 1:] * n + (pose.x, pose.y)


def test_an_outline_moves_with_its_pose():
    np.testing.assert_allclose(
        tractor_outline(AWAY, 0.3, VEHICLE), moved(tractor_outline(HOME, 0.3, VEHICLE), AWAY), atol=1e-12
    )
    np.testing.assert_allclose(trailer_outline(AWAY, VEHICLE), moved(trailer_outline(HOME, VEHICLE), AWAY), atol=1e-12)


def test_mirrored_steering_mirrors_the_tractor():
    left, right = tractor_outline(HOME, 0.4, VEHICLE), tractor_outline(HOME, -0.4, VEHICLE)
    corners = [np.unique(p[~np.isnan(p[:, 0])].round(9) + 0.0, axis=0) for p in (left, right * (1, -1))]
    np.testing.assert_array_equal(*corners)


def test_the_joints_of_a_straight_machine_are_one_drawbar_apart():
    antenna = -VEHICLE.hitch_length - VEHICLE.trailer_length + VEHICLE.trailer_antenna
    trailer = trailer_outline(Pose(x=antenna, y=0.0, yaw=0.0), VEHICLE)
    rear = np.nanmin(tractor_outline(HOME, 0.0, VEHICLE)[:, 0])
    assert rear == pytest.approx(-VEHICLE.free_joint_offset, abs=1e-12)
    assert rear - np.nanmax(trailer[:, 0]) == pytest.approx(VEHICLE.drawbar_length, abs=1e-12)
