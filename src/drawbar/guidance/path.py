"""The path to follow: poses joined by cubic Hermite pieces, continued as straight lines beyond both ends.

Points are complex numbers, east + i north: a rotation is a product, and both coordinates share one formula.
On pieces this short a Hermite cubic with unit tangents has unit speed and follows an arc of radius 6.67 m to
1e-7 m and 1e-6 rad, one of 2.5 m to 1e-6 m and 1e-5 rad. A look-up costs the same for any length of path.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from drawbar.errors import PathError
from drawbar.geometry import Floats

Complexes = NDArray[np.complex128]

PIECE_LENGTH = 0.25
"""longest piece, m: the accuracy of the cubics and the grid of the projection rest on it"""

_NEWTON_STEPS = 20
_CONVERGED = 1e-6
"""last Newton step, m; what is left after it is of its square"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Path:
    """A line with continuous yaw, its arc length counted from 0 at the start to `length` at the end.

    Row 0 and the last row of the arrays are the straight continuations; the n rows between are the pieces.
    """

    anchors: Floats
    """(n+2,): arc length at which each row's cubic is anchored: 0, then the n+1 nodes, m"""
    yaws: Floats
    """(n+2,): continuous yaw at the anchors, rad"""
    cubics: Complexes
    """(4, n+2): coefficients in the distance from the anchor, constant first; m, 1, 1/m, 1/m²"""
    label_of_piece: NDArray[np.int8]
    """(n,): index into label_names"""
    label_names: tuple[str, ...]
    """the classes a report tells apart, e.g. ("straight", "0.1")"""

    @classmethod
    def through(
        cls,
        *,
        arc_length: Floats,
        x: Floats,
        y: Floats,
        yaw: Floats,
        label_of_piece: NDArray[np.int8],
        label_names: tuple[str, ...],
    ) -> Self:
        """Join n+1 poses (m, rad) at the given arc lengths (m) by n pieces, each of the class labelled.

        Raises PathError when a number is not finite or the arc length does not increase from 0.
        """
        length = np.diff(arc_length)
        finite = np.isfinite(arc_length).all() and np.isfinite(x + y + yaw).all()
        if not (finite and len(length) > 0 and arc_length[0] == 0.0 and (length > 0.0).all()):
            raise PathError("a path needs finite poses and an arc length that increases from 0")
        position, tangent = x + 1j * y, np.exp(1j * yaw)
        mean = np.diff(position) / length
        cubics = np.zeros((4, len(length) + 2), dtype=np.complex128)
        cubics[:2, 0] = position[0], tangent[0]
        cubics[:2, 1:] = position, tangent
        cubics[2, 1:-1] = (3.0 * mean - 2.0 * tangent[:-1] - tangent[1:]) / length
        cubics[3, 1:-1] = (tangent[:-1] + tangent[1:] - 2.0 * mean) / length**2
        return cls(
            anchors=np.concatenate([[0.0], arc_length]),
            yaws=np.concatenate([yaw[:1], yaw]),
            cubics=cubics,
            label_of_piece=label_of_piece,
            label_names=label_names,
        )

    @property
    def length(self) -> float:
        """Arc length of the whole path, m."""
        return float(self.anchors[-1])

    def sample(self, arc_length: Floats) -> Floats:
        """Return (..., 4): x (m), y (m), continuous yaw (rad), curvature (1/m) at arc lengths (...) in m."""
        row = self.anchors[1:].searchsorted(arc_length, "right")
        distance = (arc_length - self.anchors.take(row)).astype(np.complex128)  # cast once, not in each product
        start, forward, square, cube = self.cubics.take(row, 1)
        slope = distance * cube
        bend = square + 3.0 * slope  # half the second derivative
        inner = distance * (square + slope)
        position = start + distance * (forward + inner)
        tangent = forward + inner + inner + distance * slope
        turn = tangent * forward.conj()
        samples = np.empty((*row.shape, 4))
        samples[..., 0], samples[..., 1] = position.real, position.imag
        samples[..., 2] = self.yaws.take(row) + np.arctan2(turn.imag, turn.real)
        samples[..., 3] = 2.0 * (tangent.conj() * bend).imag
        return samples

    def labels(self, arc_length: Floats) -> list[str]:
        """Return the class of the path at each arc length (m); beyond the ends that of the nearest piece."""
        piece = self.anchors[2:-1].searchsorted(arc_length, "right")
        return [self.label_names[index] for index in self.label_of_piece[piece]]

    def project(self, x: float, y: float, low: float, high: float) -> tuple[float, float]:
        """Return arc length (m) of the point of the path closest to (x, y), and the lateral error (m).

        Only arc lengths from low to high are searched. The error is positive when (x, y) is left of the path.
        The nearest node starts a Newton iteration on the distance along the tangent.
        """
        point = complex(x, y)
        first, last = self.anchors[1:].searchsorted((low, high)).tolist()
        row = first + int(np.abs(self.cubics[0, first : last + 2] - point).argmin())
        arc_length = min(max(float(self.anchors[row]), low), high)
        for _ in range(_NEWTON_STEPS):
            row = self._row_at(arc_length, row)
            error, curvature = self._seen_from(point, arc_length, row)
            # 1 - curvature * lateral is the slope of the distance along; it vanishes at the centre of
            # curvature, where the bound keeps the step from running away.
            step = error.real / max(1.0 - curvature * error.imag, 0.2)
            moved = min(max(arc_length + step, low), high)
            converged = abs(moved - arc_length) <= _CONVERGED
            arc_length = moved
            if converged:
                break
        return arc_length, error.imag

    def _row_at(self, arc_length: float, row: int) -> int:
        """Walk from `row` to the one that holds arc_length (m)."""
        anchors = self.anchors
        while row > 0 and arc_length < anchors[row]:
            row -= 1
        while row + 1 < len(anchors) and arc_length >= anchors[row + 1]:
            row += 1
        return row

    def _seen_from(self, point: complex, arc_length: float, row: int) -> tuple[complex, float]:
        """Return a point in the path's frame there, ahead + i left (m), and the path's curvature (1/m)."""
        c_0, c_1, c_2, c_3 = self.cubics[:, row].tolist()
        distance = arc_length - float(self.anchors[row])
        backward = (c_1 + distance * (2.0 * c_2 + 3.0 * distance * c_3)).conjugate()
        offset = point - c_0 - distance * (c_1 + distance * (c_2 + distance * c_3))
        return offset * backward, 2.0 * (backward * (c_2 + 3.0 * distance * c_3)).imag
