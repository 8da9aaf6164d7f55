"""What the controllers on the chain share: feed-forward, steering bounds, the trailer's antenna behind a plan."""

import math

import numpy as np

from drawbar.geometry import Floats
from drawbar.optimal import Bound
from drawbar.signals import Estimate
from drawbar.vehicle.parameters import VehicleParameters

_OVERSTEER = 1e3
"""Penalty per radian on a planned steering angle beyond its limit: soft, since the estimate may lie beyond it."""


def steering_bounds(limit: float, rate: float, body: str = "") -> dict[str, Bound]:
    """Return the soft bound on a steering angle (rad) and the hard one on its rate (rad/s), by the model's names."""
    return {
        f"{body}steering": Bound(lower=-limit, upper=limit, linear_penalty=_OVERSTEER),
        f"{body}steering_rate": Bound(lower=-rate, upper=rate),
    }


def curvature_steering(vehicle: VehicleParameters, estimate: Estimate, curvature: Floats) -> Floats:
    """Return the steering (n,), rad, that holds the tractor on curvatures (n,), 1/m, for the estimated slip."""
    slope = vehicle.wheelbase * curvature + math.tan(estimate.tractor_crab)
    steering: Floats = (np.arctan(slope) - estimate.steering_offset) / estimate.tractor_slip
    return steering


class TrailerPoses:
    """Forward kinematics of the chain over a whole plan."""

    def __init__(self, vehicle: VehicleParameters, stages: int) -> None:
        """Take the lengths and the number of poses in a plan."""
        back = vehicle.trailer_length - vehicle.trailer_antenna
        self._back = -np.array([vehicle.free_joint_offset, vehicle.drawbar_length, back], complex)
        self._angles = np.zeros((3, stages), complex)

    def behind(self, tractor: Floats, yaw: Floats, joint: Floats) -> Floats:
        """Return the trailer antenna's poses (n, 3): x, y (m), yaw (rad).

        Args:
            tractor: (n, 3) its poses.
            yaw: (n,) psi, rad.
            joint: (n,) J, rad.
        """
        angles = self._angles.imag
        angles[0], angles[1], angles[2] = tractor[:, 2], yaw + joint, yaw
        antenna = self._back @ np.exp(self._angles)
        poses = np.empty((len(yaw), 3))
        poses[:, 0] = tractor[:, 0] + antenna.real
        poses[:, 1] = tractor[:, 1] + antenna.imag
        poses[:, 2] = yaw
        return poses
