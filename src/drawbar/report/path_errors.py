"""Path errors: how far both bodies were from the line that was followed; their tracked points on the ground.

The line is the path, or one beside it: a nudged one, or a neighbouring pass. How far beside, each step has in the
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
_NEAR = 2.0
"""m along the path from the place that the controller reports, within which the search finds the track"""
_ASIDE = 10.0
"""m beside that place, beyond which it is another path's"""
_PLACES = 0.25
"""between two places of the path that are looked at for the nearest one, m"""
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
    return _path_errors(path, progress, error, start)


def _path_errors(path: Path, progress: Floats, error: Floats, start: float) -> PathErrors:
    classes = path.classes(np.nan_to_num(progress, nan=start))
    return PathErrors(progress=progress, error=error, classes=classes, label_names=path.label_names)


def _project_stretches(path: Path, track: Floats, near: Floats, left_out: NDArray[np.bool_]) -> PathErrors:
    """Project a track on the path, each stretch of it anew: what is left out between them may be as long as it likes.

    Args:
        path: to project on.
        track: (n, 2), m.
        near: (n,): arc lengths near which it was, as far as they are known, m.
        left_out: (n,): steps at which nothing is projected.
    """
    progress, error = np.full((2, len(track)), np.nan)
    for stretch in np.split(np.arange(len(track)), np.flatnonzero(np.diff(left_out)) + 1):
        if len(stretch) and not left_out[stretch[0]]:
            x, y = track[stretch].T
            found = project_track(path, x, y, _start(path, track[stretch], near[stretch]))
            progress[stretch], error[stretch] = found.progress, found.error
    return _path_errors(path, progress, error, _first_known(near))


def _start(path: Path, track: Floats, near: Floats) -> float:
    """Return the arc length near which a track (n, 2) begins, m: the controller's, where that is of this path.

    That of a pass beside it, or of the path driven the other way, is another path's: then the nearest place is taken.
    """
    start, known = _first_known(near), np.flatnonzero(np.isfinite(track).all(axis=1) & np.isfinite(near))
    if not known.size:
        return start
    place = track[known[0]]
    x, y, yaw, _ = path.sample(np.array(start))
    away = complex(*(place - (x, y))) * np.exp(-1j * yaw)
    if abs(away.real) <= _NEAR and abs(away.imag) <= _ASIDE:
        return start
    arc_lengths = np.arange(-_ASIDE, path.length + _ASIDE, _PLACES)
    distances = np.linalg.norm(path.sample(arc_lengths)[:, :2] - place, axis=1)
    nearest = arc_lengths[distances <= distances.min() + _PLACES]
    return float(nearest[np.abs(nearest - start).argmin()])


def true_path_errors(log: Columns) -> Bodies[PathErrors]:
    """Return the true errors of both bodies at every step of a log."""
    return _errors(log, "truth", np.zeros(log.steps, dtype=bool))


def estimated_path_errors(log: Columns, at: NDArray[np.bool_] | None = None) -> Bodies[PathErrors]:
    """Return the errors of both bodies as they were estimated, by default while the autopilot was engaged.

    Args:
        log: of a run.
        at: (n,): the steps at which they are wanted; at others they are NaN.
    """
    return _errors(log, "estimate", ~(engaged(log) if at is None else at))


def _errors(log: Columns, source: str, left_out: NDArray[np.bool_]) -> Bodies[PathErrors]:
    path = log.header.path.path()

    def of_body(body: str) -> PathErrors:
        near = log.column(f"reference.{body}.progress")
        errors = _project_stretches(path, track_of(log, body, source), near, left_out)
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
