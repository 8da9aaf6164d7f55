"""Angles, planar rotations and the local tangent plane. Radians, metres, ENU, counter-clockwise from east."""

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def wrap(angle: float) -> float:
    """Return the angle in [-π, π) rad; for differences only, never for states."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def nearest_branch(angle: float, target: float) -> float:
    """Return the angle shifted by a multiple of 2π to within π of the target, rad."""
    return angle + 2.0 * math.pi * round((target - angle) / (2.0 * math.pi))


def arm_offset(yaw: float, roll: float, pitch: float, arm: tuple[float, float, float]) -> tuple[float, float]:
    """Return how far east and north of a body's point something on an arm stands, m.

    The body's axes are forward, left, up; it is turned by R = Rz(yaw) Ry(-pitch) Rx(roll).

    Args:
        yaw: rad.
        roll: right side down positive, rad.
        pitch: nose up positive, rad.
        arm: forward, left and up of the point in the body's axes, m.
    """
    forward, left, up = arm
    raised = left * math.sin(roll) + up * math.cos(roll)
    ahead = forward * math.cos(pitch) - raised * math.sin(pitch)
    beside = left * math.cos(roll) - up * math.sin(roll)
    return ahead * math.cos(yaw) - beside * math.sin(yaw), ahead * math.sin(yaw) + beside * math.cos(yaw)


def east_north(latitude: Floats, longitude: Floats, origin: tuple[float, float]) -> tuple[Floats, Floats]:
    """Project WGS84 degrees onto the local tangent plane at origin (latitude, longitude in degrees).

    Returns east and north in metres, from the ellipsoid's radii of curvature at the origin; the error is
    below 1 cm within 1 km.
    """
    axis, eccentricity_squared = 6378137.0, 6.69437999014e-3
    latitude_0, longitude_0 = origin
    slope = 1.0 - eccentricity_squared * math.sin(math.radians(latitude_0)) ** 2
    meridian = axis * (1.0 - eccentricity_squared) / slope**1.5
    parallel = axis / math.sqrt(slope) * math.cos(math.radians(latitude_0))
    return parallel * np.radians(longitude - longitude_0), meridian * np.radians(latitude - latitude_0)
