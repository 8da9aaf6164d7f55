"""Geometry: angles, gravity, local frame on the WGS84 ellipsoid. Radians, metres, ENU, counter-clockwise from east."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

GRAVITY = 9.81
"""m/s²; geometry.h has it in C"""

_AXIS, _FLATTENING = 6378137.0, 1.0 / 298.257223563
"""of the ellipsoid of WGS84: equatorial radius, m, and flattening"""
_ECCENTRICITY_SQUARED = _FLATTENING * (2.0 - _FLATTENING)


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


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalFrame:
    """East, north and up from an origin on WGS84: the one frame of recorded lines and of fixes, exact at any distance.

    A point without a height is taken at the origin's, and so must be every point that is compared with it: a line has
    no heights, and 100 m of height make 16 mm of each km. Source: the ellipsoid in Cartesian coordinates (ECEF).
    """

    latitude: float
    """of the origin, degrees"""
    longitude: float
    """of the origin, degrees"""
    height: float = 0.0
    """of the origin above the ellipsoid, m"""

    def east_north(self, latitude: Floats | float, longitude: Floats | float) -> tuple[Floats, Floats]:
        """Return east and north (...), m, of WGS84 degrees (...), taken at the origin's height."""
        east, north, _ = self.east_north_up(latitude, longitude, self.height)
        return east, north

    def east_north_up(
        self, latitude: Floats | float, longitude: Floats | float, height: Floats | float
    ) -> tuple[Floats, Floats, Floats]:
        """Return east, north and up (m) of WGS84 degrees and heights above the ellipsoid (m)."""
        away = geocentric(latitude, longitude, height) - self._at((0.0, 0.0, 0.0))
        east, north, up = np.moveaxis(away @ self._axes(), -1, 0)
        return east, north, up

    def wgs84(
        self, east: Floats | float, north: Floats | float, up: Floats | float = 0.0
    ) -> tuple[Floats, Floats, Floats]:
        """Return latitude, longitude (degrees) and height (m) of a point of the frame (m); errors below 1 nm."""
        return geodetic(self._at(np.stack(np.broadcast_arrays(east, north, up), axis=-1)))

    def level(self, east: Floats | float, north: Floats | float) -> tuple[Floats, Floats]:
        """Return the WGS84 degrees at the origin's height that `east_north` puts at east and north (m)."""
        up = np.zeros(np.broadcast_shapes(np.shape(east), np.shape(north)))
        for _ in range(3):  # each round is a million times closer
            latitude, longitude, height = self.wgs84(east, north, up)
            up = up + self.height - height
        return latitude, longitude

    def _at(self, local: tuple[float, float, float] | Floats) -> Floats:
        """Return local coordinates (..., 3) in Cartesian ones, m."""
        return geocentric(self.latitude, self.longitude, self.height) + np.asarray(local) @ self._axes().T

    def _axes(self) -> Floats:
        """Return the unit vectors east, north and up as the columns of a matrix (3, 3)."""
        phi, lam = math.radians(self.latitude), math.radians(self.longitude)
        sin_phi, cos_phi, sin_lam, cos_lam = math.sin(phi), math.cos(phi), math.sin(lam), math.cos(lam)
        return np.array(
            [
                [-sin_lam, -sin_phi * cos_lam, cos_phi * cos_lam],
                [cos_lam, -sin_phi * sin_lam, cos_phi * sin_lam],
                [0.0, cos_phi, sin_phi],
            ]
        )


def geocentric(latitude: Floats | float, longitude: Floats | float, height: Floats | float) -> Floats:
    """Return WGS84 degrees (...) and heights above the ellipsoid (...), m, in Cartesian coordinates (..., 3), m."""
    phi, lam = np.radians(latitude), np.radians(longitude)
    normal = _AXIS / np.sqrt(1.0 - _ECCENTRICITY_SQUARED * np.sin(phi) ** 2)
    across = (normal + height) * np.cos(phi)
    along = (normal * (1.0 - _ECCENTRICITY_SQUARED) + height) * np.sin(phi)
    return np.stack(np.broadcast_arrays(across * np.cos(lam), across * np.sin(lam), along), axis=-1)


def geodetic(point: Floats) -> tuple[Floats, Floats, Floats]:
    """Return latitude, longitude (WGS84 degrees) and height (m) of Cartesian coordinates (..., 3), m.

    By iteration on the normal's foot; errors below 1 nm within 10 km of the ellipsoid.
    """
    x, y, z = np.moveaxis(point, -1, 0)
    across = np.hypot(x, y)
    phi = np.arctan2(z, across * (1.0 - _ECCENTRICITY_SQUARED))
    for _ in range(4):  # each round gains a factor of 1e5 at the heights of fields
        normal = _AXIS / np.sqrt(1.0 - _ECCENTRICITY_SQUARED * np.sin(phi) ** 2)
        phi = np.arctan2(z + _ECCENTRICITY_SQUARED * normal * np.sin(phi), across)
    normal = _AXIS / np.sqrt(1.0 - _ECCENTRICITY_SQUARED * np.sin(phi) ** 2)
    height = across * np.cos(phi) + z * np.sin(phi) - _AXIS**2 / normal
    return np.degrees(phi), np.degrees(np.arctan2(y, x)), height
