"""Field fence: whether the vehicle is about to cross the field's boundary, or has.

The tractor follows its path within centimetres, so the path shows where it will be. It must be inside as far as the
front axle comes until the vehicle stands: in a headland pass the tractor may face the boundary and yet never come near.
Curves that AgOpenGPS records go on beyond the field by a hundred metres, and may lie along its boundary.
"""

import math
from pathlib import Path as FilePath

import numpy as np

from drawbar.config import Configuration
from drawbar.driving.devices.path_frame import local_frame
from drawbar.driving.loop.driven_line import DrivenLine
from drawbar.fields.edge import load_edge
from drawbar.geometry import Floats
from drawbar.guidance.path import Path
from drawbar.signals import Estimate, StepRecord

_REACTION, _DECELERATION = 1.2, 1.5
"""of the driver who is told to stop, s, and of the vehicle, m/s²"""
_APART = 0.25
"""between points of the path that are looked at, m"""
_TOGETHER = 64
"""points that are looked at together"""
_STAYS = 20.0
"""length of a piece of the path in the field on which a stand-in begins, m"""

Truths = np.ndarray[tuple[int], np.dtype[np.bool_]]


class FieldFence:
    """The field's edge, and which bodies have been inside."""

    def __init__(self, configuration: Configuration, ring: Floats) -> None:
        """Take the field's edge: (n, 2), m, in the frame of the path; the last point joins the first."""
        self._wheelbase, self._speed = configuration.vehicle.wheelbase, configuration.speed
        self._begins, self._edges = ring, np.roll(ring, -1, axis=0) - ring
        self._spans = np.sort([ring[:, 1], ring[:, 1] + self._edges[:, 1]], axis=0).T
        self._beyond = configuration.path.beyond_boundary
        self._trailer_was_inside = False

    def contains(self, points: Floats) -> Truths:
        """Return (n,) whether points (n, 2), m, are inside, or no farther outside than allowed."""
        pieces = [self._contains(points[i : i + _TOGETHER]) for i in range(0, len(points), _TOGETHER)]
        return np.concatenate([*pieces, np.zeros(0, bool)])

    def _contains(self, points: Floats) -> Truths:
        """Do it with the edges alone that are not north or south of all of them: a field may have 100,000."""
        low, high = points[:, 1].min() - self._beyond, points[:, 1].max() + self._beyond
        beside = (self._spans[:, 0] <= high) & (self._spans[:, 1] >= low)
        begins, edges = self._begins[beside], self._edges[beside]
        inside = _surrounds(begins, edges, points)
        inside[~inside] = _distances(begins, edges, points[~inside]) <= self._beyond
        return inside

    def outside(self, path: Path) -> float:
        """Return how much of a path lies farther outside than allowed, m."""
        points = path.sample(np.arange(0.0, path.length, _APART))[:, :2]
        return _APART * float((~self.contains(points)).sum())

    def entry(self, path: Path) -> float:
        """Return the arc length from which on a path stays inside for `_STAYS`, or to its end, m; 0: there is none."""
        places = np.arange(0.0, path.length, _APART)
        leaves = np.flatnonzero(~self.contains(path.sample(places)[:, :2]))
        ends = np.append(leaves, len(places))
        begins = np.append(0, leaves + 1)
        stays = np.minimum(round(_STAYS / _APART), len(places) - begins)
        fits = begins[(ends - begins >= stays) & (begins < len(places))]
        return _APART * float(fits[0]) if len(fits) else 0.0

    def is_reached(self, record: StepRecord, line: DrivenLine) -> bool:
        """Return whether the tractor is outside or will be before it stands, or the trailer has come out."""
        axles = _axles(record.estimate)
        if not np.isfinite([*axles.ravel(), record.reference.tractor.progress]).all():
            return False  # nothing is estimated yet, which stands against engaging by itself
        tractor, trailer = self.contains(axles).tolist()
        came_out = self._trailer_was_inside and not trailer
        self._trailer_was_inside |= trailer
        return not tractor or came_out or not bool(self.contains(self._ahead(record, line)).all())

    def begin(self) -> None:
        """Begin anew: the trailer may come into the field behind the tractor."""
        self._trailer_was_inside = False

    def _ahead(self, record: StepRecord, line: DrivenLine) -> Floats:
        """Return the points (n, 2), m, over which the front axle comes until the vehicle stands."""
        speed = record.estimate.speed if math.isfinite(record.estimate.speed) else self._speed
        way = max(speed, 0.0) * _REACTION + speed**2 / (2.0 * _DECELERATION)
        begin = record.reference.tractor.progress
        reach = begin + self._wheelbase + way
        places = np.linspace(begin, reach, math.ceil((reach - begin) / _APART) + 1)
        x, y, yaw, _ = line.path.sample(np.clip(places, 0.0, line.path.length)).T
        return np.column_stack([x - line.left * np.sin(yaw), y + line.left * np.cos(yaw)])


def build_fence(configuration: Configuration) -> FieldFence | None:
    """Return the fence of the field in which a configuration's line lies; None: its file holds none.

    Raises:
        PathError: the line or the boundary cannot be read.
    """
    settings = configuration.path
    ring = load_edge(FilePath(settings.file), local_frame(configuration)) if settings.file else None
    return None if ring is None else FieldFence(configuration, ring)


def _axles(estimate: Estimate) -> Floats:
    """Return the middle of the tractor's rear axle, and of the trailer's, (2, 2) m."""
    return np.array([(body.x, body.y) for body in (estimate.tractor, estimate.trailer)])


def _surrounds(begins: Floats, edges: Floats, points: Floats) -> Truths:
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
