"""Terrain: the ground's height, a slope and unevenness with a stated spectrum."""

import math
from typing import Self

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.settings import TerrainSettings

_WAVES = 160
_STREAM = 1
"""of a run's seed that is the ground's own"""


class Terrain:
    """The height of the ground at any place: a plane plus a sum of plane waves in all directions.

    The power of the waves is spread evenly over the wavelengths from the shortest to the longest. A section through
    such a field has a power spectral density that falls with the square of the wave number, as roads and fields have it
    (ISO 8608, w = 2), between these two wavelengths.
    """

    @classmethod
    def of_seed(cls, settings: TerrainSettings, seed: int) -> Self:
        """Return the ground of a run: the same in every machine."""
        return cls(settings, np.random.default_rng((seed, _STREAM)))

    def __init__(self, settings: TerrainSettings, rng: np.random.Generator) -> None:
        """Draw directions and phases of the waves."""
        rise = -math.tan(settings.slope)
        self._plane = rise * math.cos(settings.downhill), rise * math.sin(settings.downhill)
        strata = (np.arange(_WAVES) + rng.random(_WAVES)) / _WAVES
        numbers = 2.0 * np.pi / (settings.shortest + (settings.longest - settings.shortest) * strata)
        directions, self._phases = 2.0 * np.pi * rng.random((2, _WAVES))
        self._east, self._north = numbers * np.cos(directions), numbers * np.sin(directions)
        self._amplitude = settings.unevenness * math.sqrt(2.0 / _WAVES)

    def height(self, x: Floats, y: Floats) -> Floats:
        """Return the height (n,) of the ground at the places x, y (n,), m."""
        height: Floats = self._plane[0] * x + self._plane[1] * y
        if self._amplitude:
            phases = np.multiply.outer(x, self._east) + np.multiply.outer(y, self._north) + self._phases
            height = height + self._amplitude * np.cos(phases).sum(axis=-1)
        return height

    def tangents(self, x: Floats, y: Floats) -> Floats:
        """Return the planes (n, 3) that touch the ground at the places x, y (n,).

        Columns: height at the origin (m), slope to the east, slope to the north.
        """
        height = self._plane[0] * x + self._plane[1] * y
        east, north = np.full_like(height, self._plane[0]), np.full_like(height, self._plane[1])
        if self._amplitude:
            phases = np.multiply.outer(x, self._east) + np.multiply.outer(y, self._north) + self._phases
            height = height + self._amplitude * np.cos(phases).sum(axis=-1)
            falling = -self._amplitude * np.sin(phases)
            east, north = east + falling @ self._east, north + falling @ self._north
        return np.column_stack((height - east * x - north * y, east, north))

    def unevenness(self, x: Floats, y: Floats) -> Floats:
        """Return how far the ground at the places x, y (n,) is above the slope, m."""
        height: Floats = self.height(x, y) - self._plane[0] * x - self._plane[1] * y
        return height

    def falls(self) -> tuple[float, float]:
        """Return the angles at which the plane falls to the east and to the north, rad."""
        return math.atan(-self._plane[0]), math.atan(-self._plane[1])

    def across(self, yaw: float) -> float:
        """Return the angle at which the plane falls to the left of a yaw, rad."""
        return math.atan(self._plane[0] * math.sin(yaw) - self._plane[1] * math.cos(yaw))
