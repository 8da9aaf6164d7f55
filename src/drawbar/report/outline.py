"""Outlines of tractor and trailer for the map, as they look from above.

Joints and axles sit where the vehicle's lengths put them; widths and wheels are drawn to please.
"""

import math

import numpy as np

from drawbar.geometry import Floats
from drawbar.signals import Pose
from drawbar.vehicle.parameters import VehicleParameters

_GAP = np.full((1, 2), np.nan)


def _box(x: float, y: float, length: float, width: float, yaw: float = 0.0) -> Floats:
    """Return a closed rectangle (5, 2) around (x, y), turned by yaw, and a gap."""
    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1], [1, 1]]) * (0.5 * length, 0.5 * width)
    return np.vstack([_turned(corners, yaw) + np.array([x, y]), _GAP])


def _turned(points: Floats, yaw: float) -> Floats:
    cos, sin = math.cos(yaw), math.sin(yaw)
    rotation: Floats = np.array([[cos, sin], [-sin, cos]])
    turned: Floats = np.matmul(points, rotation)
    return turned


def _placed(shapes: list[Floats], pose: Pose) -> Floats:
    position: Floats = np.array([pose.x, pose.y])
    return _turned(np.vstack(shapes), pose.yaw) + position


def tractor_outline(pose: Pose, steering: float, vehicle: VehicleParameters) -> Floats:
    """Return the tractor from above, (n, 2) in m, shapes separated by NaN; pose is that of the rear axle."""
    front, joint = vehicle.wheelbase, -vehicle.free_joint_offset
    shapes = [_box(0.5 * front, 0.0, front + 0.5, 0.5), _box(0.5 * joint, 0.0, -joint, 0.08)]
    shapes += [_box(0.0, side, 0.8, 0.26) for side in (-0.5, 0.5)]
    shapes += [_box(front, side, 0.5, 0.18, steering) for side in (-0.42, 0.42)]
    return _placed(shapes, pose)


def trailer_outline(pose: Pose, vehicle: VehicleParameters) -> Floats:
    """Return the trailer from above, (n, 2) in m, shapes separated by NaN; pose is that of the tracked point."""
    axle = -vehicle.trailer_antenna
    joint = axle + vehicle.trailer_length
    bed_front = axle + 0.6 * vehicle.trailer_length
    bed_length = bed_front - axle + 0.6
    shapes = [_box(bed_front - 0.5 * bed_length, 0.0, bed_length, 0.8)]
    shapes += [_box(0.5 * (joint + bed_front), 0.0, joint - bed_front, 0.08)]
    shapes += [_box(axle, side, 0.55, 0.2) for side in (-0.55, 0.55)]
    return _placed(shapes, pose)
