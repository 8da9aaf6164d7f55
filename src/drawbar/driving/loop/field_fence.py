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
from drawbar.fields.edge import FieldEdge, load_edge
from drawbar.fields.ring import Ring, Truths
from drawbar.geometry import Floats
from drawbar.guidance.path import Path
from drawbar.signals import Estimate, StepRecord

_REACTION, _DECELERATION = 1.2, 1.5
"""of the driver who is told to stop, s, and of the vehicle, m/s²"""
_APART = 0.25
"""between points of the path that are looked at, m"""
_STAYS = 20.0
"""length of a piece of the path in the field on which a stand-in begins, m"""


class FieldFence:
    """The field's edge, and which bodies have been inside."""

    def __init__(self, configuration: Configuration, edge: FieldEdge) -> None:
        """Take the field's edge, in the frame of the path."""
        self._wheelbase, self._speed = configuration.vehicle.wheelbase, configuration.speed
        self._edge, self._holes = Ring(edge.ring), [Ring(hole) for hole in edge.holes]
        self._beyond = configuration.path.beyond_boundary
        self._trailer_was_inside = False

    def contains(self, points: Floats) -> Truths:
        """Return (n,) whether points (n, 2), m, are in the field or no farther beyond its edge than allowed."""
        inside = self._edge.surrounds(points, self._beyond)
        for hole in self._holes:
            inside &= ~hole.surrounds(points)
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
    edge = load_edge(FilePath(settings.file), local_frame(configuration)) if settings.file else None
    return None if edge is None else FieldFence(configuration, edge)


def _axles(estimate: Estimate) -> Floats:
    """Return the middle of the tractor's rear axle, and of the trailer's, (2, 2) m."""
    return np.array([(body.x, body.y) for body in (estimate.tractor, estimate.trailer)])
