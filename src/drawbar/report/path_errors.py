"""Path errors: how far both bodies were from the line that was followed; their tracked points on the ground.

The line is the path, or one beside it: a nudged one, or a neighbouring pass. How far beside, each step tells by the
point of the line that it found closest. Logs of drawbars that did not record it for a tool are judged by the path.
"""

from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.guidance.path import Path
from drawbar.recording.log import Columns
from drawbar.report.columns import engaged, line_points, track_of

T = TypeVar("T")

_BEHIND, _AHEAD = 1.0, 3.0
"""m around the last closest point that are searched: the path crosses itself, a global search would jump"""
_ROUNDS = 5
"""of Newton's, after which a foot on the path is found"""
_FOUND = 1e-3
"""m along the path that it may lack"""
_SAME = 1e-6
"""m beside the path that are rounding"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bodies(Generic[T]):
    """The same figure of both bodies."""

    tractor: T
    trailer: T


@dataclass(frozen=True, slots=True, kw_only=True)
class PathErrors:
    """Where one body's point on the ground truly was with respect to the line: n steps."""

    progress: Floats
    """(n,): arc length of the path's closest point, m; NaN where it is not known"""
    error: Floats
    """(n,): signed distance from the line, to the left as the path leads positive, m; NaN where it is not known"""
    classes: NDArray[np.int8]
    """(n,): class of the path at the closest point, index into label_names"""
    label_names: tuple[str, ...]

    def of_class(self, label: str) -> NDArray[np.bool_]:
        """Return at which steps the path was of a class, (n,)."""
        known = label in self.label_names
        return self.classes == self.label_names.index(label) if known else np.zeros(len(self.classes), dtype=bool)


def project_track(path: Path, x: Floats, y: Floats, start: float) -> PathErrors:
    """Project a track (n,) of positions (m) on the path, beginning near the arc length `start` (m)."""
    progress, error = path.project_track(x, y, start, behind=_BEHIND, ahead=_AHEAD)
    classes = path.classes(np.nan_to_num(progress, nan=start))
    return PathErrors(progress=progress, error=error, classes=classes, label_names=path.label_names)


def true_path_errors(log: Columns) -> Bodies[PathErrors]:
    """Return the true errors of both bodies at every step of a log."""
    return _errors(log, "truth", np.zeros(log.steps, dtype=bool))


def estimated_path_errors(log: Columns) -> Bodies[PathErrors]:
    """Return the errors of both bodies as they were estimated while the autopilot was engaged; else they are NaN."""
    return _errors(log, "estimate", ~engaged(log))


def _errors(log: Columns, source: str, left_out: NDArray[np.bool_]) -> Bodies[PathErrors]:
    path = log.header.path.path()

    def of_body(body: str) -> PathErrors:
        x, y = track_of(log, body, source).T
        x[left_out] = np.nan
        errors = project_track(path, x, y, _first_known(log.column(f"reference.{body}.progress")))
        return replace(errors, error=errors.error - _offsets(path, errors.progress, *line_points(log, body).T))

    return Bodies(tractor=of_body("tractor"), trailer=of_body("trailer"))


def _first_known(progress: Floats) -> float:
    known = progress[np.isfinite(progress)]
    return float(known[0]) if known.size else 0.0


def _offsets(path: Path, near: Floats, x: Floats, y: Floats) -> Floats:
    """Return how far to the left of the path points (n,) of the line are, m; where that is not known, as before it.

    Args:
        path: that the line is beside.
        near: (n,): arc lengths next to the points, m.
        x: (n,) of the points, m.
        y: (n,) of the points, m.
    """
    place, along, left = near, np.full(len(near), np.nan), np.full(len(near), np.nan)
    for _ in range(_ROUNDS):
        foot_x, foot_y, yaw, curvature = path.sample(place).T
        along = np.cos(yaw) * (x - foot_x) + np.sin(yaw) * (y - foot_y)
        left = np.cos(yaw) * (y - foot_y) - np.sin(yaw) * (x - foot_x)
        place = place + along / np.maximum(1.0 - curvature * left, 0.2)
    known = np.flatnonzero(np.abs(along) < _FOUND)
    if not known.size:
        return np.zeros(len(near))
    left = left[known[np.maximum(known.searchsorted(np.arange(len(near)), "right") - 1, 0)]]
    return np.where(np.abs(left) > _SAME, left, 0.0)
