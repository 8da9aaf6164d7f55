"""Off-tracking: how far apart the tracks of both bodies stay on a circle, whatever a controller does."""

import math

import numpy as np

from drawbar.geometry import Floats
from drawbar.vehicle.parameters import VehicleParameters


def steady_off_tracking(vehicle: VehicleParameters, curvatures: Floats) -> Floats:
    """Return how far from the circle (n,) of the tractor's tracked point the trailer's stays, steered as helps, m.

    Everything turns about one centre, without side-slip (docs/theory/off-tracking.md).

    Args:
        vehicle: lengths and steering limit.
        curvatures: (n,) of that circle, not zero, 1/m; where the trailer would fold up it turns on the spot.
    """
    radius, limit = 1.0 / np.abs(curvatures), vehicle.trailer_steering_limit
    ahead = vehicle.trailer_length + vehicle.drawbar_length * math.cos(limit)  # of the trailer's axle, to RJ1
    lateral = vehicle.drawbar_length * math.sin(limit)
    forward, left = vehicle.tracked.tractor.arm
    turn = np.sign(curvatures)  # points to the left are nearer to the centre of a curve to the left
    tractor = np.sqrt(np.fmax(radius**2 - forward**2, 0.0)) + turn * left
    axle = (
        np.sqrt(np.fmax(tractor**2 + vehicle.free_joint_offset**2 - ahead**2, 0.0))
        - turn * vehicle.tracked.trailer.left
    )
    inner, outer = (np.hypot(axle + side, vehicle.trailer_point) for side in (-lateral, lateral))
    return np.fmax(0.0, np.fmax(inner - radius, radius - outer))
