"""Hand steering: how the person on the stand-in's seat steers along the line while drawbar does not.

Pure pursuit of a point of the line ahead, in the direction in which the tractor faces:
tan(steering) = 2 wheelbase sin(bearing) / distance. Who has passed the line's end has that point behind, and turns
round.
"""

import math
from contextlib import suppress

import numpy as np

from drawbar.errors import PathError
from drawbar.guidance.path import Path
from drawbar.signals import Truth
from drawbar.vehicle.parameters import VehicleParameters

_AHEAD = 3.0
"""from the rear axle to the point that is pursued, along the line, m"""
_REACH = 30.0
"""how far away a place of the line may be that leads where the tractor faces, m"""
_LEAVES = math.radians(1.0)
"""by which the wheels may stand otherwise than he would turn them"""
_SHARE = 0.6
"""of the steering limit, which he turns at most: a trailer is not to jackknife"""


class HandSteering:
    """Somebody who knows the line, and steers along it by sight."""

    def __init__(self, path: Path, vehicle: VehicleParameters) -> None:
        """Take the configured line and the vehicle."""
        self._configured = self._path = path
        self._offset = 0.0
        self._wheelbase, self._most = vehicle.wheelbase, _SHARE * vehicle.tractor_steering_limit

    def choose(self, offset: float) -> None:
        """Take the line so far to the left of the configured one, m; one that curves too tightly is not taken."""
        if offset != self._offset:
            self._offset = offset
            with suppress(PathError):
                self._path = self._configured.beside(offset)

    def __call__(self, truth: Truth) -> float | None:
        """Return the angle to which the front wheels are turned, rad; None: they are right as they are."""
        pose, path = truth.tractor, self._path
        place, against = path.nearest(pose.x, pose.y, pose.yaw, reach=_REACH, both_ways=True)
        aim = min(max(place + (-_AHEAD if against else _AHEAD), 0.0), path.length)
        x, y, *_ = path.sample(np.array(aim)).tolist()
        east, north = x - pose.x, y - pose.y
        bearing = math.remainder(math.atan2(north, east) - pose.yaw, math.tau)
        if abs(bearing) > 0.5 * math.pi:
            return math.copysign(self._most, bearing)
        wanted = math.atan2(2.0 * self._wheelbase * math.sin(bearing), math.hypot(east, north))
        wanted = min(max(wanted, -self._most), self._most)
        return wanted if abs(wanted - truth.tractor_steering) > _LEAVES else None
