"""Uncertainty of an estimate: standard deviations across the line and of the yaw."""

import numpy as np
import pytest
from ordinary import believed

from drawbar.config import load_configuration
from drawbar.driving.loop.estimate_uncertainty import lateral_and_heading
from drawbar.signals import Pose
from drawbar.vehicle.articulated import trailer_antenna
from drawbar.vehicle.lengths import lengths_of

SEED = 11


def estimate_of(x, y, theta, psi, joint):
    return believed(Pose(x=x, y=y, yaw=theta), Pose(x=0.0, y=0.0, yaw=psi), trailer_steering=joint)


def test_uncertainty_is_what_many_draws_show():
    vehicle = load_configuration("articulated").vehicle
    rng = np.random.default_rng(SEED)
    root = 0.02 * rng.standard_normal((8, 8))
    covariance = root @ root.T
    place = np.array([3.0, -2.0, 0.4, 0.1, 0.05, -0.2])
    lateral, heading = lateral_and_heading(vehicle, estimate_of(*place[:4], place[5]), covariance)
    draws = place + rng.multivariate_normal(np.zeros(8), covariance, 200_000)[:, :6]
    lengths, _ = lengths_of(vehicle)
    a, d = vehicle.free_joint_offset, vehicle.drawbar_length
    back = vehicle.trailer_length - vehicle.trailer_antenna

    def antenna(x, y, theta, psi, _steering, joint):
        phi = psi + joint
        east = x - a * np.cos(theta) - d * np.cos(phi) - back * np.cos(psi)
        return east, y - a * np.sin(theta) - d * np.sin(phi) - back * np.sin(psi)

    assert [float(each) for each in trailer_antenna(lengths, *place[:4], place[5])] != []
    spread = []
    for yaw, (x, y) in ((place[2], draws[:, :2].T), (place[3], antenna(*draws.T))):
        spread.append(np.std(-np.sin(yaw) * x + np.cos(yaw) * y))
    assert lateral == pytest.approx(max(spread), rel=0.02)
    assert heading == pytest.approx(np.std(draws[:, 2:4], axis=0).max(), rel=0.01)
