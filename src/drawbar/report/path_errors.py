"""How far both bodies truly were from the path: their true points on the ground, projected on it."""

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.guidance.path import Path
from drawbar.recording.log import RunLog

T = TypeVar("T")

_BEHIND, _AHEAD = 1.0, 3.0
"""m around the last closest point that are searched: the path crosses itself, a global search would jump"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bodies(Generic[T]):
    """The same figure of both bodies."""

    tractor: T
    trailer: T


@dataclass(frozen=True, slots=True, kw_only=True)
class PathErrors:
    """Where one body's point on the ground truly was with respect to the path: n steps."""

    progress: Floats
    """(n,): arc length of the closest point, m; NaN without truth"""
    error: Floats
    """(n,): signed distance, left of the path positive, m; NaN without truth"""
    labels: NDArray[np.str_]
    """(n,): class of the path at the closest point"""


def project_track(path: Path, x: Floats, y: Floats, start: float) -> PathErrors:
    """Project a track (n,) of positions (m) on the path, beginning near the arc length `start` (m)."""
    progress, error = np.full(len(x), np.nan), np.full(len(x), np.nan)
    last = start
    for step in np.flatnonzero(np.isfinite(x) & np.isfinite(y)):
        last, error[step] = path.project(float(x[step]), float(y[step]), last - _BEHIND, last + _AHEAD)
        progress[step] = last
    labels = path.labels(np.nan_to_num(progress, nan=start))
    return PathErrors(progress=progress, error=error, labels=np.array(labels, dtype=np.str_))


def true_path_errors(log: RunLog) -> Bodies[PathErrors]:
    """Return the true errors of both bodies at every step of a log."""
    path = log.header.path.path()

    def of_body(body: str) -> PathErrors:
        believed = log.column(f"reference.{body}.progress")
        start = float(believed[0]) if believed.size else 0.0
        x, y = log.column(f"truth.{body}.x"), log.column(f"truth.{body}.y")
        return project_track(path, x, y, start)

    return Bodies(tractor=of_body("tractor"), trailer=of_body("trailer"))
