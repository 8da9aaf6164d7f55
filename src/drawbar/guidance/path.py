"""The path to follow: poses joined by cubic Hermite pieces, continued as straight lines beyond both ends.

The arithmetic is C (path.h); a look-up costs about the same for any length of path.
"""

import ctypes
import math
from dataclasses import dataclass
from functools import cache
from typing import Self

import numpy as np
from numpy.typing import NDArray

from drawbar.codegen import build
from drawbar.codegen.library import load
from drawbar.errors import PathError, demand_number
from drawbar.geometry import Floats

Complexes = NDArray[np.complex128]

PIECE_LENGTH = 0.25
"""longest piece, m: the accuracy of the cubics and the grid of the projection rest on it"""
LEAST_STRETCH = 0.1
"""of a parallel line against its path, where it runs inside of a curve"""

PATH_UNIT = """\
/* The path. */
#include "path_check.h"
#include "path_evaluation.h"
"""
"""the unit of a library that defines what path.h declares"""
_TRACK = """\
void track(const struct path *path, const double *x, const double *y, int64_t count, double start, double behind,
           double ahead, double *progress, double *error)
{
    for (int64_t i = 0; i < count; ++i)
        if (isfinite(x[i]) && isfinite(y[i]))
            start = progress[i] = drawbar_path_project(path, x[i], y[i], start - behind, start + ahead, &error[i]);
}
"""


class CPath(ctypes.Structure):
    """struct path, over nodes that it keeps alive."""

    _fields_ = (("nodes", ctypes.c_void_p), ("count", ctypes.c_int32), ("offset", ctypes.c_void_p))

    def __init__(self, nodes: Floats) -> None:
        super().__init__(nodes.ctypes.data, len(nodes), None)
        self._owner = nodes


@dataclass(frozen=True, slots=True, kw_only=True)
class Path:
    """A line with continuous yaw, its arc length counted from 0 at the start to `length` at the end."""

    nodes: Floats
    """(n+1, 4): arc length (m), x, y (m) and continuous yaw (rad) where the n pieces meet"""
    label_of_piece: NDArray[np.int8]
    """(n,): index into label_names"""
    label_names: tuple[str, ...]
    """the classes that a report distinguishes, e.g. ("straight", "0.1")"""

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
        nodes = np.column_stack([arc_length, x, y, yaw]).astype(np.float64, order="C", copy=False)
        if len(nodes) < 2:
            raise PathError(f"a path needs at least two poses, got {len(nodes)}")
        advances = np.concatenate([nodes[:1, 0] == 0.0, np.diff(nodes[:, 0]) > 0.0])
        for bad in np.flatnonzero(~(advances & np.isfinite(nodes).all(axis=1)))[:1].tolist():
            raise PathError(
                f"pose {bad} of a path is (arc length, x, y, yaw) = {nodes[bad].tolist()}; poses must be finite, and "
                f"the arc length must begin at 0 and increase from pose to pose"
            )
        return cls(nodes=nodes, label_of_piece=label_of_piece, label_names=label_names)

    @property
    def length(self) -> float:
        """Arc length of the whole path, m."""
        return float(self.nodes[-1, 0])

    def broken_node(self) -> int:
        """Return the first node that drawbar_set_path refuses, -1 where the path can be followed."""
        return int(_library().drawbar_path_check(CPath(self.nodes)))

    def sample(self, arc_length: Floats) -> Floats:
        """Return (..., 4): x (m), y (m), continuous yaw (rad), curvature (1/m) at arc lengths (...) in m."""
        asked = np.asarray(arc_length, dtype=np.float64, order="C")
        samples = np.empty((*asked.shape, 4))
        _library().drawbar_path_samples(CPath(self.nodes), asked.ctypes.data, asked.size, samples.ctypes.data)
        return samples

    def beside(self, offset: float) -> Self:
        """Return the parallel line so far to the left (right: negative), m.

        Raises:
            PathError: the path curves too tightly towards that side, or the offset is no length.
        """
        demand_number("offset", offset, "give m", PathError)
        if not math.isfinite(offset):
            raise PathError(f"offset = {offset} m is not allowed: give a finite one, to the left positive")
        if offset == 0.0:
            return self
        nodes = self.nodes[:, 0]
        curvature = self.sample(nodes)[:, 3]
        stretch = 1.0 - offset * curvature  # d(new arc length) / d(arc length)
        if not float(stretch.min()) > LEAST_STRETCH:
            furthest = (1.0 - LEAST_STRETCH) / float((math.copysign(1.0, offset) * curvature).max())
            raise PathError(
                f"offset = {offset:g} m: the path curves too tightly for a line so far beside it; "
                f"give less than {math.floor(100.0 * furthest) / 100.0:.2f} m to this side"
            )
        longest = float((np.diff(nodes) * np.maximum(stretch[1:], stretch[:-1])).max())
        pieces = math.ceil(longest / PIECE_LENGTH)  # of each of this path's
        count = len(nodes) - 1
        places = np.interp(np.arange(count * pieces + 1) / pieces, np.arange(count + 1), nodes)
        x, y, yaw, _ = self.sample(places).T
        return type(self).through(
            arc_length=places - offset * (yaw - yaw[0]),  # the integral of the stretch
            x=x - offset * np.sin(yaw),
            y=y + offset * np.cos(yaw),
            yaw=yaw,
            label_of_piece=np.repeat(self.label_of_piece, pieces),
            label_names=self.label_names,
        )

    def reversed(self) -> Self:
        """Return the path from its end to its start."""
        arc_length, x, y, yaw = self.nodes[::-1].T
        return type(self).through(
            arc_length=self.length - arc_length,
            x=x,
            y=y,
            yaw=yaw + math.pi,
            label_of_piece=self.label_of_piece[::-1],
            label_names=self.label_names,
        )

    def labels(self, arc_length: Floats) -> list[str]:
        """Return the class of the path at each arc length (n,), m; beyond the ends that of the nearest piece."""
        return [self.label_names[index] for index in self.classes(arc_length)]

    def classes(self, arc_length: Floats) -> NDArray[np.int8]:
        """Return the same as indices into label_names, (...) of arc lengths (...) in m."""
        return self.label_of_piece[self.nodes[1:-1, 0].searchsorted(arc_length, "right")]

    def project(self, x: float, y: float, low: float, high: float) -> tuple[float, float]:
        """Return arc length (m) of the point of the path closest to (x, y), and the lateral error (m).

        Only arc lengths from low to high are searched. The error is positive when (x, y) is left of the path.
        The nearest node starts a Newton iteration on the distance along the tangent.
        """
        error = ctypes.c_double()
        arc_length = _library().drawbar_path_project(CPath(self.nodes), x, y, low, high, ctypes.byref(error))
        return float(arc_length), error.value

    def nearest(self, x: float, y: float, yaw: float, *, reach: float, both_ways: bool) -> tuple[float, bool]:
        """Return the arc length (m) of the path's nearest place, and whether the path leads the other way there.

        A place that leads where the vehicle faces goes before a nearer one that leads across; of several passes that
        are alike the first is taken. The other way: by more than 120 degrees.

        Args:
            x: of the vehicle, m.
            y: of the vehicle, m.
            yaw: where it faces, NaN where that is not known, rad.
            reach: how far away a place may be that goes before a nearer one, m.
            both_ways: a place that leads against the vehicle is as good.
        """
        against = ctypes.c_int()
        nearest = _library().drawbar_path_nearest
        arc_length = nearest(CPath(self.nodes), x, y, yaw, reach, both_ways, ctypes.byref(against))
        return float(arc_length), bool(against.value)

    def project_track(
        self, x: Floats, y: Floats, start: float, *, behind: float, ahead: float
    ) -> tuple[Floats, Floats]:
        """Project places one after the other, each searched near the one before.

        Args:
            x: (n,) m; a place with NaN is passed over.
            y: (n,) m.
            start: arc length near which the first one is searched, m.
            behind: how far behind the last arc length is searched, m.
            ahead: how far ahead of it, m.

        Returns:
            Arc lengths (n,) and lateral errors (n,), m, as of project(); NaN where the place was.
        """
        given = [np.ascontiguousarray(each, dtype=np.float64) for each in (x, y)]
        found = np.full(len(x), np.nan), np.full(len(x), np.nan)
        places, results = ([each.ctypes.data for each in arrays] for arrays in (given, found))
        _library().track(CPath(self.nodes), *places, len(x), start, behind, ahead, *results)
        return found


@cache
def _library() -> ctypes.CDLL:
    """Return the compiled functions of a path."""
    library = load(build("path", PATH_UNIT + _TRACK))
    path, real, pointer, count = ctypes.POINTER(CPath), ctypes.c_double, ctypes.c_void_p, ctypes.c_int64
    functions = {
        "drawbar_path_check": (ctypes.c_int32, (path,)),
        "drawbar_path_samples": (None, (path, pointer, count, pointer)),
        "drawbar_path_project": (real, (path, real, real, real, real, ctypes.POINTER(real))),
        "drawbar_path_nearest": (
            real,
            (path, real, real, real, real, ctypes.c_int, ctypes.POINTER(ctypes.c_int)),
        ),
        "track": (None, (path, pointer, pointer, count, real, real, real, pointer, pointer)),
    }
    for name, (result, arguments) in functions.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library
