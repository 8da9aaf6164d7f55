"""Slide: how the ground draws every axle, on a slope downhill and in a curve outwards."""

import math
from typing import NamedTuple

from drawbar.geometry import GRAVITY


class Slide(NamedTuple):
    """What estimators look for (estimation/slide.h)."""

    east: float
    """side-slip of an axle by the slope, to the east, rad"""
    north: float
    """to the north"""
    creep: float
    """by a curve, rad per side acceleration in g"""

    def across(self, yaw: float, speed: float, yaw_rate: float) -> float:
        """Return the side-slip to the left of an axle that faces and turns so, rad; speed in m/s, yaw rate in rad/s."""
        drawn = self.north * math.cos(yaw) - self.east * math.sin(yaw)
        return drawn - self.creep * speed * yaw_rate / GRAVITY
