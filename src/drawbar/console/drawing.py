"""Drawing: what the browser needs to draw the field, once and at each step; m (east, north) and rad."""

import math
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from drawbar.config import Configuration
from drawbar.console.thinning import kept_points
from drawbar.control.tube.tube import SubsystemTube
from drawbar.errors import DrawbarError
from drawbar.fields.exchange import read_fields
from drawbar.fields.lines import on_plane
from drawbar.geometry import Floats, LocalFrame, arm_offset, wrap
from drawbar.guidance.importers.load import LINE_FILES
from drawbar.guidance.path import LEAST_STRETCH, Path
from drawbar.messages import Fixes
from drawbar.report.outline import tractor_outline, trailer_outline
from drawbar.signals import Pose, StepRecord
from drawbar.step.build import build_tubes
from drawbar.vehicle.parameters import VehicleParameters

_TOLERANCE, _POINTS = 0.01, 20_000
"""m by which the drawn line may leave the path, as long as it takes no more points"""
_STEERED = 2
"""shapes of the tractor's outline that are its front wheels, the last ones"""
_BESIDE = (-2, -1, 1, 2)
"""neighbours that are drawn"""
_ZERO = Pose(x=0.0, y=0.0, yaw=0.0)

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

    @property
    def bodies(self) -> tuple[float, ...]:
        """x, y and yaw of tractor and trailer, as they are shown."""
        return tuple(round(each, 4) for each in (*self.tractor, *self.trailer))

    def to_browser(self) -> dict[str, Any]:
        """Return it as JSON."""
        return {
            "tractor": list(self.bodies[:3]),
            "trailer": list(self.bodies[3:]),
            "steering": round(self.steering, 4),
            "plans": list(self.plans),
        }


class Lines:
    """The line that is driven and those beside it, as JSON; by how far it is left of the configured one, m."""

    def __init__(self, path: Path, working_width: float) -> None:
        """Take the configured line, and the distance between lines, m; 0: there is only one."""
        nodes, curvatures = path.nodes, path.sample(path.nodes[:, 0])[:, 3]
        self._nodes = nodes[kept_points(nodes[:, 1:3], _TOLERANCE, _POINTS)]
        self._tightest = float(curvatures.min()), float(curvatures.max())
        self._path, self._width = path, working_width
        self._newest = (0.0, self._drawn(0.0))

    def __call__(self, offset: float) -> dict[str, Any]:
        """Return the lines around an offset."""
        if self._newest[0] != offset:
            self._newest = (offset, self._drawn(offset))
        return self._newest[1]

    def nearest_pass(self, x: float, y: float, yaw: float) -> int:
        """Return the number of the pass that is nearest to a vehicle (m, rad); left of the configured line positive.

        Where the line crosses itself, the part that leads along the vehicle counts.
        """
        beside, _ = self._path.nearest(x, y, yaw, reach=math.inf, both_ways=True)
        _, left = self._path.project(x, y, beside, beside)
        return round(left / self._width)

    def _drawn(self, offset: float) -> dict[str, Any]:
        beside = [offset + count * self._width for count in _BESIDE] if self._width > 0.0 else []
        drawn = [self._beside(each) for each in beside]
        return {"path": self._beside(offset), "neighbours": [each for each in drawn if each]}

    def _beside(self, offset: float) -> Points:
        """Return the parallel line so far to the left, m; empty where the path curves too tightly for one."""
        if not min(1.0 - offset * each for each in self._tightest) > LEAST_STRETCH:
            return []
        _, x, y, yaw = self._nodes.T
        return _rounded(np.column_stack([x - offset * np.sin(yaw), y + offset * np.cos(yaw)]))


def boundary(configuration: Configuration, frame: LocalFrame) -> Points:
    """Return the boundary of the field of the configured line, m of its frame; empty where none is known."""
    file = configuration.path.file
    if not file:
        return []
    source = FilePath(file)
    try:
        fields = read_fields(source.parent if source.name.lower() in LINE_FILES else source, frame)
    except DrawbarError:
        return []  # the line has been read, and is driven without
    ring = next((field.boundary for field in fields if field.boundary is not None), None)
    return [] if ring is None else _rounded(on_plane(ring, frame))


def tube_widths(configuration: Configuration) -> tuple[float, float]:
    """Return how far beside its plan the tubes let tractor and trailer be, m; 0 where none is declared.

    The tube of the product's trailer is one of its articulation: it swings about the hitch by so much.
    """
    tubes, vehicle = build_tubes(configuration), configuration.vehicle
    if tubes is None:
        return 0.0, 0.0
    lever = vehicle.drawbar_length + vehicle.trailer_length - vehicle.trailer_antenna
    return _width(tubes.tractor, lever), _width(tubes.trailer, lever)


def _width(tube: SubsystemTube, lever: float) -> float:
    first = tube.model.states[0]
    extent = float(tube.support(np.eye(1, len(tube.model.states)))[0])
    width = lever * math.sin(min(extent, 0.5 * math.pi)) if first == "articulation" else extent
    return round(width, 4) if math.isfinite(width) else 0.0


def standing(
    vehicle: VehicleParameters,
    speed: float,
    working_width: float,
    ring: Points,
    tubes: tuple[float, float] = (0.0, 0.0),
) -> dict[str, Any]:
    """Return what never changes, as JSON: both bodies' shapes in their own frames, set speed (m/s), boundary, tubes."""
    axle = -vehicle.trailer_antenna
    return {
        "speed": speed,
        "workingWidth": working_width,
        "boundary": ring,
        "tubes": list(tubes),
        "tractor": _shapes(tractor_outline(_ZERO, 0.0, vehicle)),
        "trailer": _shapes(trailer_outline(_ZERO, vehicle)),
        "steered": _STEERED,
        "tractorJoint": -vehicle.free_joint_offset,
        "trailerJoint": axle + vehicle.trailer_length,
    }


def moving(record: StepRecord) -> Moving | None:
    """Return both bodies' places in a step; None: it has none."""
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


def moving_by_hand(place: tuple[float, float, float], fixes: Fixes, vehicle: VehicleParameters) -> Moving | None:
    """Return where both bodies are by their receivers alone, away from any line; None: where they face is not known.

    Args:
        place: of the tractor, with its yaw, NaN if not known.
        fixes: of both receivers.
        vehicle: its lengths and masts; the steered joint is taken as straight.
    """
    x, y, yaw = place
    if not math.isfinite(yaw):
        return None
    joint = x - vehicle.free_joint_offset * math.cos(yaw), y - vehicle.free_joint_offset * math.sin(yaw)
    reach = vehicle.drawbar_length + vehicle.trailer_length - vehicle.trailer_antenna
    forward, left, _ = vehicle.masts.trailer.arm
    faces = math.atan2(joint[1] - fixes.trailer.y, joint[0] - fixes.trailer.x) - math.atan2(-left, reach - forward)
    if math.isfinite(faces):
        east, north = arm_offset(faces, 0.0, 0.0, (forward, left, 0.0))
        trailer = fixes.trailer.x - east, fixes.trailer.y - north, wrap(faces)
    else:  # it has no receiver: drawn straight behind
        trailer = joint[0] - reach * math.cos(yaw), joint[1] - reach * math.sin(yaw), yaw
    return Moving(tractor=(x, y, yaw), trailer=trailer, steering=0.0, plans=([], []))


def _plan(poses: Floats) -> Points:
    points = poses[:, :2]
    return _rounded(points) if bool(np.isfinite(points).all()) else []


def _shapes(outline: Floats) -> list[Points]:
    ends = np.flatnonzero(np.isnan(outline[:, 0]))
    return [_rounded(shape[~np.isnan(shape[:, 0])]) for shape in np.split(outline, ends + 1) if len(shape)]


def _rounded(points: Floats) -> Points:
    rounded: Points = np.round(points, 3).tolist()
    return rounded
