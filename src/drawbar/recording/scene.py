"""Scene: a run as messages with well-known schemas, so that Foxglove shows map, 3D scene and transforms by itself.

Frames: `field`, east-north-up from the path's origin; `tractor` and `trailer`, forward-left-up at the estimated places
of their antennas, on the ground. Needs the extra `machine` (foxglove-sdk).
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from foxglove.messages import (
    Color,
    CubePrimitive,
    FrameTransform,
    FrameTransforms,
    LinePrimitive,
    LinePrimitiveLineType,
    LocationFix,
    LocationFixPositionCovarianceType,
    Point3,
    Pose,
    Quaternion,
    SceneEntity,
    SceneUpdate,
    Timestamp,
    Vector3,
)

from drawbar.control.tube.tube import SubsystemTube, Tubes
from drawbar.geometry import Floats, LocalFrame
from drawbar.guidance.path import Path
from drawbar.signals import BodyPlan, StepRecord
from drawbar.signals import Pose as Place
from drawbar.vehicle.parameters import VehicleParameters

FIELD, TRACTOR, TRAILER = "field", "tractor", "trailer"
_PATH, _PLANS = Color(r=0.45, g=0.45, b=0.45, a=1.0), {TRACTOR: (0.12, 0.47, 0.71), TRAILER: (0.85, 0.37, 0.01)}
_WIDTH, _HEIGHT = 1.2, 0.6
"""of the boxes that stand for the bodies, m"""
_TOOL = 0.15
"""of the line to a point of `vehicle.tracked`, m"""
_GRID = 1024.0
"""places in a metre: what is drawn to a millimetre has short mantissas, and compresses"""
_PLAN_GRID, _TURNS = 64.0, 2.0**16
"""places of a plan in a metre, and of a quaternion's numbers in one, likewise"""
_TUBE = 0.2
"""opacity of a tube"""
_DRAWN = 5000
"""points of the path, at most"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """What is drawn of a run, and where the field lies."""

    path: Path
    vehicle: VehicleParameters
    frame: LocalFrame | None = None
    """of the path; None: not known, and there is no map"""
    reach: Mapping[str, float] = field(default_factory=dict)
    """how far a body's tube reaches to either side of its plan, m; a body without a set is not in it"""

    def standing(self, time: int) -> Iterator[tuple[str, Any]]:
        """Yield topic and message of what does not change, at a time in ns: the path and the bodies' shapes."""
        every = max(1, len(self.path.nodes) // _DRAWN)
        line = _line(self.path.nodes[::every, 1:3], _PATH, 0.04)
        path = SceneEntity(timestamp=_stamp(time), frame_id=FIELD, id="path", lines=[line])
        yield "/path", SceneUpdate(entities=[path])
        yield "/bodies", SceneUpdate(entities=[self._body(time, TRACTOR), self._body(time, TRAILER)])

    def moving(self, time: int, record: StepRecord) -> Iterator[tuple[str, Any]]:
        """Yield topic and message of one step, at a time in ns: fixes, places and plans."""
        estimate, measured = record.estimate, record.measurement
        if self.frame is not None:
            yield from self._fix(time, TRACTOR, measured.tractor_x, measured.tractor_y, measured.tractor_fix_deviation)
            yield from self._fix(time, TRAILER, measured.trailer_x, measured.trailer_y, measured.trailer_fix_deviation)
        places = ((TRACTOR, estimate.tractor), (TRAILER, estimate.trailer))
        known = [
            _transform(time, body, place) for body, place in places if math.isfinite(place.x + place.y + place.yaw)
        ]
        yield "/tf", FrameTransforms(transforms=known)
        plans = ((TRACTOR, record.plan.tractor), (TRAILER, record.plan.trailer))
        known_plans = [(body, plan) for body, plan in plans if math.isfinite(float(plan.poses.sum()))]
        drawn = [_plan(time, body, plan, self.reach.get(body, 0.0)) for body, plan in known_plans]
        if drawn:
            yield "/plan", SceneUpdate(entities=drawn)

    def _fix(self, time: int, body: str, x: float, y: float, deviation: float) -> Iterator[tuple[str, Any]]:
        if self.frame is None or not math.isfinite(x + y):
            return
        latitude, longitude = (float(each) for each in self.frame.level(x, y))
        known = math.isfinite(deviation)
        variance = deviation**2 if known else 0.0
        yield (
            f"/{body}/fix",
            LocationFix(
                timestamp=_stamp(time),
                frame_id=body,
                latitude=latitude,
                longitude=longitude,
                position_covariance=[variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, 4.0 * variance],
                position_covariance_type=LocationFixPositionCovarianceType.Approximated
                if known
                else LocationFixPositionCovarianceType.Unknown,
            ),
        )

    def _body(self, time: int, body: str) -> SceneEntity:
        """Return a body as boxes in its own frame, whose origin is the foot of its antenna."""
        vehicle, shade = self.vehicle, Color(**dict(zip("rgb", _PLANS[body], strict=True)), a=0.7)
        if body == TRACTOR:
            boxes = [
                _box(-0.4, vehicle.wheelbase + 0.3, _WIDTH, shade),
                _box(-vehicle.free_joint_offset, 0.0, 0.1, shade),
            ]
        else:
            axle = -vehicle.trailer_antenna
            boxes = [_box(axle - 1.0, axle + 1.0, _WIDTH, shade), _box(axle, axle + vehicle.trailer_length, 0.1, shade)]
        arm = getattr(vehicle.tracked, body).arm
        tool = [_line(np.array([(0.0, 0.0), arm]), shade, _TOOL)] if any(arm) else []
        return SceneEntity(timestamp=_stamp(time), frame_id=body, id=body, frame_locked=True, cubes=boxes, lines=tool)


def tube_reach(tubes: Tubes | None, vehicle: VehicleParameters) -> dict[str, float]:
    """Return how far each body's tube reaches to either side of its plan, m; of those bodies that have a set.

    A trailer whose error is its joint's angle is drawn as far aside as that angle moves its axle.
    """
    bodies = {} if tubes is None else {TRACTOR: tubes.tractor, TRAILER: tubes.trailer}
    return {body: _reach(tube, vehicle) for body, tube in bodies.items() if tube.invariant_set is not None}


def _reach(tube: SubsystemTube, vehicle: VehicleParameters) -> float:
    states = list(tube.model.states)
    aside = "lateral" if "lateral" in states else "articulation"
    extent = float(tube.support(np.eye(len(states)))[states.index(aside)])
    return extent if aside == "lateral" else math.sin(extent) * vehicle.trailer_length


def _plan(time: int, body: str, plan: BodyPlan, reach: float) -> SceneEntity:
    """Return a plan as a line through every other of its poses, in the middle of its tube."""
    r, g, b = _PLANS[body]
    widths = [(0.06, 1.0), *([(2.0 * reach, _TUBE)] if reach > 0.0 else [])]
    lines = [_line(plan.poses[::2, :2], Color(r=r, g=g, b=b, a=a), width, _PLAN_GRID) for width, a in widths]
    return SceneEntity(timestamp=_stamp(time), frame_id=FIELD, id=body, lines=lines)


def _transform(time: int, body: str, place: Place) -> FrameTransform:
    return FrameTransform(
        timestamp=_stamp(time),
        parent_frame_id=FIELD,
        child_frame_id=body,
        translation=Vector3(x=_on_grid(place.x, _GRID), y=_on_grid(place.y, _GRID), z=0.0),
        rotation=Quaternion(
            x=0.0, y=0.0, z=_on_grid(math.sin(place.yaw / 2.0), _TURNS), w=_on_grid(math.cos(place.yaw / 2.0), _TURNS)
        ),
    )


def _box(back: float, front: float, width: float, color: Color) -> CubePrimitive:
    """Return a box from `back` to `front` (m, along the body) on the ground."""
    middle = Vector3(x=(back + front) / 2.0, y=0.0, z=_HEIGHT / 2.0)
    return CubePrimitive(
        pose=Pose(position=middle, orientation=Quaternion(w=1.0)),
        size=Vector3(x=abs(front - back), y=width, z=_HEIGHT),
        color=color,
    )


def _on_grid(value: float, grid: float) -> float:
    return round(value * grid) / grid


def _line(points: Floats, color: Color, width: float, grid: float = _GRID) -> LinePrimitive:
    """Return a line through points (n, 2), m, to the nearest of the grid."""
    return LinePrimitive(
        type=LinePrimitiveLineType.LineStrip,
        pose=Pose(position=Vector3(), orientation=Quaternion(w=1.0)),
        thickness=width,
        points=[Point3(x=x, y=y, z=0.05) for x, y in (np.round(points * grid) / grid).tolist()],
        color=color,
    )


def _stamp(time: int) -> Timestamp:
    return Timestamp(*divmod(time, 1_000_000_000))
