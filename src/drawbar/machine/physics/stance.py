"""Stance of both bodies: their points on the ground and attitudes, out of MuJoCo's frames."""

import math
from typing import NamedTuple

from drawbar.geometry import Floats, nearest_branch


class Stance(NamedTuple):
    """One body."""

    x: float
    """of its point on the ground, m"""
    y: float
    z: float
    yaw: float
    """continuous, rad"""
    roll: float
    """right side down positive, rad"""
    pitch: float
    """nose up positive, rad"""


def stance(place: Floats, axes: Floats, foot: tuple[float, float], yaw: float) -> Stance:
    """Return how a body stands.

    Args:
        place: (3,) of its frame, m.
        axes: (9,) of its frame: forward, left, up in columns, written by rows.
        foot: how far forward and up of the frame's origin its point on the ground is, m.
        yaw: it had before, rad.
    """
    x, y, z = place.tolist()
    fx, _, ux, fy, _, uy, fz, lz, uz = axes.tolist()
    ahead, up = foot
    return Stance(
        x=x + ahead * fx + up * ux,
        y=y + ahead * fy + up * uy,
        z=z + ahead * fz + up * uz,
        yaw=nearest_branch(math.atan2(fy, fx), yaw),
        roll=math.atan2(lz, uz),
        pitch=math.atan2(fz, math.hypot(fx, fy)),
    )
