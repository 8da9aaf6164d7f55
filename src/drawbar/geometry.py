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


def seen_from(frame: Floats, poses: Floats) -> Floats:
    """Return poses (n, >= 3): x, y (m), yaw (rad) as seen from a frame (>= 3,): ahead, left, turned; the rest stays."""
    cosine, sine = math.cos(frame[2]), math.sin(frame[2])
    offset = poses[:, :2] - frame[:2]
    seen = poses.copy()
    seen[:, 0] = cosine * offset[:, 0] + sine * offset[:, 1]
    seen[:, 1] = cosine * offset[:, 1] - sine * offset[:, 0]
    seen[:, 2] -= frame[2]
    return seen


def placed_at(frame: Floats, poses: Floats) -> Floats:
    """Return poses (n, >= 3), given as seen from a frame (>= 3,), in the world; the inverse of seen_from."""
    cosine, sine = math.cos(frame[2]), math.sin(frame[2])
    placed = poses.copy()
    placed[:, 0] = frame[0] + cosine * poses[:, 0] - sine * poses[:, 1]
    placed[:, 1] = frame[1] + sine * poses[:, 0] + cosine * poses[:, 1]
    placed[:, 2] += frame[2]
    return placed
