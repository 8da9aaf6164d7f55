"""Solids of tractor and trailer in space: triangles on the axes of each body, from its point on the ground.

Joints and axles sit where the vehicle's lengths put them; everything else is drawn to please.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.vehicle.parameters import VehicleParameters

_SPOKES = 16


class Solid(NamedTuple):
    """Triangles."""

    corners: Floats
    """(n, 3) forward, left, up, m"""
    triangles: NDArray[np.int_]
    """(m, 3) corners of each"""


def tractor_solid(vehicle: VehicleParameters, steering: float) -> Solid:
    """Return the tractor with its front wheels at an angle (rad)."""
    base, back = vehicle.wheelbase, vehicle.free_joint_offset
    shapes = [
        _box((0.62 * base, 0.0, 0.75), (0.9 * base, 0.5, 0.45)),
        _box((-0.1, 0.0, 0.95), (0.8, 0.8, 0.25)),
        _box((-0.3, 0.0, 1.7), (0.1, 0.8, 1.3)),
        _box((-0.5 * back, 0.0, 0.4), (back, 0.08, 0.08)),
    ]
    shapes += [_wheel((0.0, side, 0.45), 0.45, 0.28) for side in (-0.6, 0.6)]
    shapes += [_wheel((base, side, 0.3), 0.3, 0.18, steering) for side in (-0.55, 0.55)]
    return joined(shapes)


def trailer_solid(vehicle: VehicleParameters) -> Solid:
    """Return the trailer."""
    axle = -vehicle.trailer_antenna
    joint, front = axle + vehicle.trailer_length, axle + 0.6 * vehicle.trailer_length
    shapes = [
        _box((0.5 * (front + axle - 0.6), 0.0, 0.75), (front - axle + 0.6, 0.95, 0.5)),
        _box((0.5 * (joint + front), 0.0, 0.4), (joint - front, 0.08, 0.08)),
    ]
    shapes += [_wheel((axle, side, 0.35), 0.35, 0.2) for side in (-0.6, 0.6)]
    return joined(shapes)


def mast_solid(arm: tuple[float, float, float]) -> Solid:
    """Return the mast that carries an antenna at (forward, left, up) of the point on the ground, m."""
    forward, left, up = arm
    shapes = [_box((forward, left, 0.5 * up), (0.05, 0.05, up)), _box((forward, left, up), (0.25, 0.25, 0.08))]
    return joined(shapes)


def tool_solid(arm: tuple[float, float]) -> Solid:
    """Return a tool at (forward, left) of the point on the ground, m, and the beam that carries it."""
    forward, left = arm
    beam = _box((0.5 * math.hypot(forward, left), 0.0, 0.3), (math.hypot(forward, left), 0.1, 0.1))
    turned = beam.corners @ rotation(math.atan2(left, forward), 0.0, 0.0).T
    return joined([Solid(turned, beam.triangles), _box((forward, left, 0.15), (0.2, 0.2, 0.3))])


def joined(solids: list[Solid]) -> Solid:
    """Return several solids as one."""
    starts = np.cumsum([0, *(len(each.corners) for each in solids)])
    triangles = [each.triangles + start for each, start in zip(solids, starts, strict=False)]
    return Solid(np.vstack([each.corners for each in solids]), np.vstack(triangles))


def rotation(yaw: float, roll: float, pitch: float) -> Floats:
    """Return the axes of a body, (3, 3) in columns: Rz(yaw) Ry(-pitch) Rx(roll)."""
    (cy, sy), (cr, sr), (cp, sp) = ((math.cos(angle), math.sin(angle)) for angle in (yaw, roll, pitch))
    about_up = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    about_left = np.array([[cp, 0.0, -sp], [0.0, 1.0, 0.0], [sp, 0.0, cp]])
    about_forward = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    axes: Floats = about_up @ about_left @ about_forward
    return axes


def _box(centre: tuple[float, float, float], size: tuple[float, float, float]) -> Solid:
    signs = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
    faces = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    triangles = [triangle for a, b, c, d in faces for triangle in ((a, b, c), (a, c, d))]
    return Solid(np.array(centre) + signs * size, np.array(triangles))


def _wheel(centre: tuple[float, float, float], radius: float, width: float, yaw: float = 0.0) -> Solid:
    """Return a drum that rolls forward, turned by yaw: two rims, then the middles of both sides."""
    angles = 2.0 * math.pi * np.arange(_SPOKES) / _SPOKES
    circle = np.column_stack((radius * np.cos(angles), np.zeros(_SPOKES), radius * np.sin(angles)))
    half_width = np.array([0.0, 0.5 * width, 0.0])
    corners = np.vstack((circle - half_width, circle + half_width, -half_width, half_width)) @ rotation(yaw, 0.0, 0.0).T
    this = np.arange(_SPOKES)
    following = (this + 1) % _SPOKES
    right, left = np.full(_SPOKES, 2 * _SPOKES), np.full(_SPOKES, 2 * _SPOKES + 1)
    columns = (
        (this, following, this + _SPOKES),
        (following, following + _SPOKES, this + _SPOKES),
        (this, right, following),
        (this + _SPOKES, following + _SPOKES, left),
    )
    return Solid(np.array(centre) + corners, np.vstack([np.column_stack(each) for each in columns]))
