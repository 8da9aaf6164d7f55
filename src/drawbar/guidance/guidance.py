"""Guidance: from where the vehicle is to what its two controllers shall follow (theory, section 7).

The closest point of each body is searched in a window around that body's last progress, never on the whole
path: where the path crosses itself a global search would jump to the other branch.
"""

import math
from abc import ABC, abstractmethod

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats, nearest_branch
from drawbar.guidance.path import Path
from drawbar.guidance.settings import GuidanceSettings
from drawbar.signals import BodyReference, Estimate, Pose, Reference

Position = tuple[float, float]
"""east and north, m"""


class Guidance(ABC):
    """The progress of both bodies along one path."""

    def __init__(self, path: Path, settings: GuidanceSettings, *, tractor: Position, trailer: Position) -> None:
        """Place both bodies on the path from where they stand (m) when the run begins.

        Raises PathError when the tractor is further than maximum_start_distance from the path's start.
        """
        self.path = path
        self.settings = settings
        reach = settings.maximum_start_distance
        _require_near_start(path, tractor, reach)
        self._tractor_progress, _ = path.project(*tractor, -reach, reach)
        # the trailer stands behind the tractor, which may itself stand behind the start
        self._trailer_progress, _ = path.project(*trailer, -3.0 * reach, reach)

    @property
    def finished(self) -> bool:
        """Whether the tractor has reached the end of the path."""
        return self._tractor_progress >= self.path.length

    def reference(self, estimate: Estimate) -> Reference:
        """Return what both controllers shall follow now, and remember the progress.

        Raises PathError when a pose of the estimate is not finite.
        """
        tractor, tractor_error = self._closest(estimate.tractor, self._tractor_progress)
        trailer, trailer_error = self._closest(estimate.trailer, self._trailer_progress)
        self._tractor_progress, self._trailer_progress = tractor, trailer
        closest = self.path.sample(self._progress()[:, 0])
        samples = self._samples(estimate)
        _to_branch(samples[0, :, 2], estimate.tractor.yaw)
        _to_branch(samples[1, :, 2], estimate.trailer.yaw)
        return Reference(
            time=estimate.time,
            tractor=BodyReference(
                progress=tractor, lateral_error=tractor_error, closest=closest[0], samples=samples[0]
            ),
            trailer=BodyReference(
                progress=trailer, lateral_error=trailer_error, closest=closest[1], samples=samples[1]
            ),
        )

    @abstractmethod
    def _samples(self, estimate: Estimate) -> Floats:
        """Return what tractor and trailer shall follow, (2, N+1, 4): as Path.sample, one row per stage."""

    def _progress(self) -> Floats:
        """Return the progress (2, 1) of tractor and trailer, m."""
        return np.array([[self._tractor_progress], [self._trailer_progress]])

    def _closest(self, pose: Pose, progress: float) -> tuple[float, float]:
        """Return arc length (m) and lateral error (m) of a body near its last progress (m)."""
        if not math.isfinite(pose.x + pose.y + pose.yaw):
            raise PathError(f"guidance: the estimated {pose} is not finite; stop the vehicle")
        settings = self.settings
        return self.path.project(pose.x, pose.y, progress - settings.window_behind, progress + settings.window_ahead)


def _to_branch(yaws: Floats, target: float) -> None:
    """Shift continuous yaws (rad) in place by the multiple of 2π that brings the first nearest to target."""
    first = float(yaws[0])
    yaws += nearest_branch(first, target) - first


def _require_near_start(path: Path, tractor: Position, reach: float) -> None:
    """Refuse a vehicle that stands too far from where the path begins, or nowhere at all."""
    x, y, _, _ = path.sample(np.zeros(1))[0].tolist()
    distance = math.hypot(tractor[0] - x, tractor[1] - y)
    if not distance <= reach:
        raise PathError(
            f"the tractor at ({tractor[0]:.2f}, {tractor[1]:.2f}) m is {distance:.2f} m from the start of "
            f"the path at ({x:.2f}, {y:.2f}) m; at most {reach:g} m is allowed: drive to the start, "
            f"or raise guidance.maximum_start_distance"
        )
