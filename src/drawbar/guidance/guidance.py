"""Guidance: from where the vehicle is to what its two controllers shall follow (docs/theory/path.md).

The closest point of each body is searched in a window around that body's last progress, never on the whole
path: where the path crosses itself a global search would jump to the other branch. The arithmetic is C,
guidance.h.
"""

import ctypes
import math
from collections.abc import Mapping
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike

from drawbar.codegen.component import Component
from drawbar.errors import PathError
from drawbar.exchange import CBodyReference, CEstimate, CMeasurement
from drawbar.guidance.path import CPath, Path
from drawbar.guidance.settings import GuidanceSettings
from drawbar.signals import BodyReference, Estimate, Pose, Reference

Position = tuple[float, float]
"""east and north, m"""


class GuidanceStatus(IntEnum):
    """enum guidance_status."""

    FINE = 0
    FAR_FROM_START = 1
    POSE_NOT_FINITE = 2
    SPEED_NOT_FINITE = 3
    NO_WAY = 4


class Guidance:
    """The progress of both bodies along one path."""

    def __init__(
        self,
        path: Path,
        settings: GuidanceSettings,
        *,
        header: str,
        values: Mapping[str, ArrayLike],
        stages: int,
        tractor: Position,
        trailer: Position,
    ) -> None:
        """Place both bodies on the path from where they stand (m) when the run begins.

        Args:
            path: to follow.
            settings: of the guidance.
            header: of the runtime, with the kind of guidance.
            values: of that kind's own settings.
            stages: of the references, which have one sample more.
            tractor: where it stands, m.
            trailer: where it stands, m.

        Raises:
            PathError: the tractor is further than maximum_start_distance from the path's start, or a position is not
                finite.
        """
        self.path = path
        self.component = Component("guidance", f'#define STAGES {stages}\n#include "{header}"\n')
        """the compiled unit"""
        self.component.write(values)
        self.component.write(
            {
                "guidance.window_behind": settings.window_behind,
                "guidance.window_ahead": settings.window_ahead,
                "guidance.start_distance": settings.maximum_start_distance,
            }
        )
        self._path, self._estimate = CPath(path.nodes), CEstimate()
        self._references = CBodyReference(), CBodyReference()
        self._samples = self.component.array("guidance.samples")
        self._reference, self._finished = (
            self.component.function("reference", 5),
            self.component.function("finished", 1),
        )
        self._begin(tractor, trailer, settings.maximum_start_distance)

    def _begin(self, tractor: Position, trailer: Position, reach: float) -> None:
        """Place both bodies on the path; see the constructor."""
        first = CMeasurement((math.nan, *tractor, *trailer, *[math.nan] * 4))
        status = self.component.function("begin", 2)(ctypes.byref(self._path), ctypes.byref(first))
        if status == GuidanceStatus.FAR_FROM_START:
            raise _far_from_start(self.path, tractor, reach)
        if status != GuidanceStatus.FINE:
            raise _no_position("trailer", trailer)

    @property
    def finished(self) -> bool:
        """Whether the tractor has reached the end of the path."""
        return bool(self._finished(ctypes.byref(self._path)))

    def reference(self, estimate: Estimate) -> Reference:
        """Return what both controllers shall follow now, and remember the progress.

        Raises PathError when the estimate's poses or speed are not finite, or the tractor faces away and no turns lead
        onto the path.
        """
        self._estimate.write(estimate)
        tractor, trailer = self._references
        status = self._reference(
            ctypes.byref(self._path),
            ctypes.byref(self._estimate),
            ctypes.byref(tractor),
            ctypes.byref(trailer),
            self.component.work,
        )
        if status != GuidanceStatus.FINE:
            raise self._refusal(status, estimate)
        return Reference(time=estimate.time, tractor=self._of_body(0), trailer=self._of_body(1))

    def _of_body(self, body: int) -> BodyReference:
        reference = self._references[body]
        return BodyReference(
            progress=reference.progress,
            lateral_error=reference.lateral_error,
            closest=np.array(reference.closest),
            samples=self._samples[body].copy(),
        )

    def _refusal(self, status: int, estimate: Estimate) -> PathError:
        """Return the error that says why there is no reference."""
        pose = next((pose for pose in (estimate.tractor, estimate.trailer) if not _finite(pose)), None)
        return PathError(f"guidance: the estimated {pose} is not finite; stop the vehicle")


def _finite(pose: Pose) -> bool:
    return math.isfinite(pose.x + pose.y + pose.yaw)


def _no_position(body: str, position: Position) -> PathError:
    """Return the error for a body whose position is not known."""
    return PathError(
        f"the {body}'s position is missing (x = {position[0]:.2f} m, y = {position[1]:.2f} m); wait for a fix of both "
        f"antennas before a run begins"
    )


def _far_from_start(path: Path, tractor: Position, reach: float) -> PathError:
    """Return the error for a tractor that is too far from where the path begins, or whose position is missing."""
    if not all(map(math.isfinite, tractor)):
        return _no_position("tractor", tractor)
    x, y, _, _ = path.sample(np.zeros(1))[0].tolist()
    distance = math.hypot(tractor[0] - x, tractor[1] - y)
    return PathError(
        f"the tractor at ({tractor[0]:.2f}, {tractor[1]:.2f}) m is {distance:.2f} m from the start of "
        f"the path at ({x:.2f}, {y:.2f}) m; at most {reach:g} m is allowed: drive to the start, "
        f"or raise guidance.maximum_start_distance"
    )
