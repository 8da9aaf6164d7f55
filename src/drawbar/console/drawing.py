"""Drawing: what the browser needs to draw the field, once and at each step; m (east, north) and rad."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from drawbar.geometry import Floats
from drawbar.guidance.path import Path
from drawbar.report.outline import tractor_outline, trailer_outline
from drawbar.signals import Pose, StepRecord
from drawbar.vehicle.parameters import VehicleParameters

_POINTS = 2000
"""of the path, at most"""
_STEERED = 2
"""shapes of the tractor's outline that are its front wheels, the last ones"""
_ZERO = Pose(x=0.0, y=0.0, yaw=0.0)

Numbers = list[float]
Points = list[list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Moving:
    """What moves, at one step."""

    tractor: tuple[float, float, float]
    trailer: tuple[float, float, float]
    steering: float
    """of the front wheels"""
    plans: tuple[Points, Points]
    """where tractor and trailer are to go"""

    def to_browser(self) -> dict[str, Any]:
        """Return it as JSON."""
        return {
            "tractor": [round(each, 4) for each in self.tractor],
            "trailer": [round(each, 4) for each in self.trailer],
            "steering": round(self.steering, 4),
            "plans": list(self.plans),
        }


def standing(path: Path, vehicle: VehicleParameters, speed: float) -> dict[str, Any]:
    """Return what does not move, as JSON: the path, both bodies' shapes in their own frames, the set speed (m/s)."""
    every = max(1, len(path.nodes) // _POINTS)
    axle = -vehicle.trailer_antenna
    return {
        "speed": speed,
        "path": _rounded(np.vstack([path.nodes[::every, 1:3], path.nodes[-1:, 1:3]])),
        "tractor": _shapes(tractor_outline(_ZERO, 0.0, vehicle)),
        "trailer": _shapes(trailer_outline(_ZERO, vehicle)),
        "steered": _STEERED,
        "tractorJoint": -vehicle.free_joint_offset,
        "trailerJoint": axle + vehicle.trailer_length,
    }


def moving(record: StepRecord) -> Moving | None:
    """Return what a step says of both bodies' places; None: it does not know them."""
    estimate = record.estimate
    places = [(each.x, each.y, each.yaw) for each in (estimate.tractor, estimate.trailer)]
    if not all(math.isfinite(value) for place in places for value in place):
        return None
    steering = estimate.tractor_steering
    return Moving(
        tractor=places[0],
        trailer=places[1],
        steering=steering if math.isfinite(steering) else 0.0,
        plans=(_plan(record.plan.tractor.poses), _plan(record.plan.trailer.poses)),
    )


def _plan(poses: Floats) -> Points:
    points = poses[:, :2]
    return _rounded(points) if bool(np.isfinite(points).all()) else []


def _shapes(outline: Floats) -> list[Points]:
    ends = np.flatnonzero(np.isnan(outline[:, 0]))
    return [_rounded(shape[~np.isnan(shape[:, 0])]) for shape in np.split(outline, ends + 1) if len(shape)]


def _rounded(points: Floats) -> Points:
    rounded: Points = np.round(points, 3).tolist()
    return rounded
