"""A closed ring of points, and what it surrounds. Pure."""

import math

import numpy as np

from drawbar.geometry import Floats

Truths = np.ndarray[tuple[int], np.dtype[np.bool_]]
_TOGETHER = 64
"""points that are looked at together"""


class Ring:
    """A ring that may have 100,000 points."""

    def __init__(self, points: Floats) -> None:
        """Take (n, 2), m; the last point joins the first."""
        self._begins, self._edges = points, np.roll(points, -1, axis=0) - points
        ends = points[:, 1] + self._edges[:, 1]
        self._south, self._north = np.minimum(points[:, 1], ends), np.maximum(points[:, 1], ends)

    def surrounds(self, points: Floats, beyond: float = 0.0) -> Truths:
        """Return (n,) whether points (n, 2), m, are inside, or outside no farther than so much beyond it, m."""
        pieces = [self._surrounds(points[i : i + _TOGETHER], beyond) for i in range(0, len(points), _TOGETHER)]
        return np.concatenate([*pieces, np.zeros(0, bool)])

    def _surrounds(self, points: Floats, beyond: float) -> Truths:
        """Do it with the edges alone that are not north or south of all these points."""
        low, high = points[:, 1].min() - beyond, points[:, 1].max() + beyond
        beside = (self._south <= high) & (self._north >= low)
        begins, edges = self._begins[beside], self._edges[beside]
        inside = _odd(begins, edges, points)
        if beyond > 0.0:
            inside[~inside] = _distances(begins, edges, points[~inside]) <= beyond
        return inside


def _odd(begins: Floats, edges: Floats, points: Floats) -> Truths:
    """Return (n,) whether a ray to the east from points (n, 2) crosses edges (m, 2) an odd number of times."""
    x, y = (points[:, None, i] - begins[:, i] for i in range(2))
    along, up = edges.T
    crosses = (y < 0.0) != (y < up)
    with np.errstate(divide="ignore", invalid="ignore"):
        odd: Truths = (crosses & (x < y / up * along)).sum(axis=1) % 2 == 1
    return odd


def _distances(begins: Floats, edges: Floats, points: Floats) -> Floats:
    """Return (n,) the distances of points (n, 2) from edges (m, 2), m; infinite without an edge."""
    apart = points[:, None] - begins
    lengths = np.maximum((edges**2).sum(axis=1), np.finfo(float).tiny)
    shares = np.clip((apart * edges).sum(axis=2) / lengths, 0.0, 1.0)
    away = np.linalg.norm(apart - shares[..., None] * edges, axis=2)
    distances: Floats = away.min(axis=1, initial=math.inf)
    return distances
