"""Track: a curve recorded while driving. Positions come in, and few enough points are kept."""

import math

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats

_APART = 0.5
"""between two points that are kept, m"""
_JUMP = 5.0
"""two positions in a row farther apart are no motion, m"""
_SHORTEST = 5.0
"""m"""
_MOST = 20_000


class Track:
    """Points of a curve, (east, north) m of one frame."""

    def __init__(self) -> None:
        """Begin with none."""
        self.points: list[tuple[float, float]] = []
        self.lost = 0
        """positions that were too far from the one before to be believed"""

    def add(self, east: float, north: float) -> bool:
        """Take a position, m; return whether it was kept. A vehicle that stands adds nothing."""
        if not math.isfinite(east + north) or len(self.points) >= _MOST:
            return False
        if self.points:
            step = math.hypot(east - self.points[-1][0], north - self.points[-1][1])
            if step > _JUMP:
                self.lost += 1
                return False
            if step < _APART:
                return False
        self.points.append((east, north))
        return True

    def line(self) -> Floats:
        """Return the curve, (n, 2) m; raises PathError where it is too short to be one."""
        points = np.array(self.points).reshape(-1, 2)
        length = float(np.hypot(*np.diff(points, axis=0).T).sum()) if len(points) > 1 else 0.0
        if not (len(points) >= 3 and length >= _SHORTEST):
            raise PathError(f"the recorded curve is {length:.1f} m long; {_SHORTEST:g} m are needed: drive on")
        return points
