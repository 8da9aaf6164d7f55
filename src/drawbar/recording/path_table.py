"""Path table of a log: the nodes of the driven path, and the points of the recorded line that it is made from."""

from dataclasses import dataclass, fields
from typing import Self

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.guidance.path import Path

_DRAWN_POINTS = 3000


@dataclass(frozen=True, slots=True, kw_only=True)
class PathTable:
    """The path of a run by its n+1 nodes; the path itself can be made from it again, exactly."""

    arc_length: Floats
    """(n+1,): m"""
    x: Floats
    """(n+1,): east, m"""
    y: Floats
    """(n+1,): north, m"""
    yaw: Floats
    """(n+1,): continuous, rad"""
    label_of_piece: NDArray[np.int8]
    """(n,): index into label_names"""
    label_names: tuple[str, ...]
    """the classes that the metrics distinguish"""

    @classmethod
    def of(cls, path: Path) -> Self:
        """Tabulate a path."""
        arc_length, x, y, yaw = path.nodes.T
        labels = path.label_of_piece
        return cls(arc_length=arc_length, x=x, y=y, yaw=yaw, label_of_piece=labels, label_names=path.label_names)

    def path(self) -> Path:
        """Make the path again."""
        return Path.through(**{field.name: getattr(self, field.name) for field in fields(self)})


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedPoints:
    """The points of a recorded line to be drawn beside its path: at most a few thousand."""

    points: Floats
    """(n, 2): east and north, m"""
    worst: int
    """row of the point that is furthest from the path"""
    deviation: float
    """of the worst point from the path, m"""

    @classmethod
    def of(cls, points: Floats, deviations: Floats) -> Self:
        """Choose from all points (n, 2) and their distances (n,) from the path, both in m; the worst stays."""
        worst = int(deviations.argmax())
        kept = np.union1d(np.arange(0, len(points), -(-len(points) // _DRAWN_POINTS)), worst)
        row = int(np.searchsorted(kept, worst))
        return cls(points=points[kept], worst=row, deviation=float(deviations[worst]))
