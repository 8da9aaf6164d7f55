"""Track: a curve recorded while driving. Positions come in, and few enough points are kept."""

import math

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats

_APART = 0.5
"""between two points that are kept, m"""
_JUMP = 5.0
"""two positions in a row farther apart are no motion, m"""
_AGREEING = 5
"""positions in a row that are near each other are accepted, however far they are from the ones before"""
_SHORTEST = 5.0
"""m"""
_MOST = 20_000


class Track:
    """Points of a curve, (east, north) m of one frame."""

    def __init__(self) -> None:
        """Begin with none."""
        self.points: list[tuple[float, float]] = []
        self.lost = 0
        """positions that were too far from the one before to be accepted"""
        self._far: list[tuple[float, float]] = []  # the newest of these, as long as they agree

    @property
    def is_full(self) -> bool:
        """Whether no more positions are taken."""
        return len(self.points) >= _MOST

    def add(self, east: float, north: float) -> bool:
        """Take a position, m; return whether it was kept. A vehicle that stands adds nothing.

        Where positions were missing for a while, as without an RTK fix, the curve continues straight across the gap.
        """
        if not math.isfinite(east + north) or self.is_full:
            return False
        place = (east, north)
        step = math.dist(place, self.points[-1]) if self.points else math.inf
        if self.points and step > _JUMP:
            return self._add_far(place)
        self._far.clear()
        if step < _APART:
            return False
        self.points.append(place)
        return True

    def _add_far(self, place: tuple[float, float]) -> bool:
        """Take a position far from the one before; return whether it and those that agree with it were kept."""
        if self._far and math.dist(place, self._far[-1]) > _JUMP:
            self._far.clear()
        self._far.append(place)
        self.lost += 1
        if len(self._far) < _AGREEING:
            return False
        agreeing, self._far = self._far, []
        self.lost -= len(agreeing)
        self.points.append(agreeing[0])
        for each in agreeing[1:]:
            self.add(*each)
        return True

    def line(self) -> Floats:
        """Return the curve, (n, 2) m; raises PathError where it is too short to be one."""
        points = np.array(self.points).reshape(-1, 2)
        length = float(np.hypot(*np.diff(points, axis=0).T).sum()) if len(points) > 1 else 0.0
        if not (len(points) >= 3 and length >= _SHORTEST):
            raise PathError(f"the recorded curve is {length:.1f} m long; {_SHORTEST:g} m are needed: drive on")
        return points
