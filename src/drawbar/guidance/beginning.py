"""Beginning of a run: from where on a path, and which way along it, a vehicle drives from where it stands."""

import math

import numpy as np

from drawbar.errors import PathError
from drawbar.guidance.path import Path
from drawbar.signals import Pose


def beginning(path: Path, vehicle: Pose, *, reach: float, both_ways: bool) -> tuple[Path, float]:
    """Return the path that a vehicle drives, turned round where it faces the other way, and where it begins on it, m.

    Near the path's start a run begins there, else at the nearest place. A path is turned round only where more of it
    than `reach` lies ahead then.

    Args:
        path: as it was recorded.
        vehicle: where the tractor stands, and faces.
        reach: how far from the path a run may begin, m.
        both_ways: the path may be driven against its direction.

    Raises:
        PathError: the vehicle stands too far away, or at the path's end.
    """
    at, against = path.nearest(vehicle.x, vehicle.y, vehicle.yaw, reach=reach, both_ways=both_ways)
    if both_ways and against and at > reach:
        return _checked(path.reversed(), path.length - at, vehicle, reach)
    x, y = path.nodes[0, 1:3].tolist()
    at = 0.0 if math.hypot(vehicle.x - x, vehicle.y - y) <= reach else at
    return _checked(path, at, vehicle, reach)


def _checked(path: Path, at: float, vehicle: Pose, reach: float) -> tuple[Path, float]:
    """Return both, where a run can begin there."""
    demand_near(path, at, vehicle.x, vehicle.y, reach)
    if not at < path.length:
        raise PathError(
            f"the tractor at ({vehicle.x:z.2f}, {vehicle.y:z.2f}) m stands at the end of the path, {path.length:.2f} "
            f"m, and nothing of it lies ahead; place it elsewhere, or let it face the other way, where a recorded line "
            f"(path.file) or a parallel one (path.working_width) is driven"
        )
    return path, at


def demand_near(path: Path, at: float, x: float, y: float, reach: float) -> None:
    """Raise PathError where a tractor at (x, y), m, is farther than `reach`, m, from where a run is to begin."""
    there_x, there_y, _, _ = path.sample(np.array(at)).tolist()
    distance = math.hypot(x - there_x, y - there_y)
    if not distance <= reach:
        raise PathError(
            f"the tractor at ({x:z.2f}, {y:z.2f}) m is {distance:.2f} m from where the run is to begin, "
            f"({there_x:z.2f}, {there_y:z.2f}) m, {at:z.2f} m along the path; at most {reach:g} m is allowed: drive "
            f"there, let the run begin elsewhere, or raise guidance.maximum_start_distance"
        )
