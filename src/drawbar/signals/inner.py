"""Inner signals: what the components of one control step hand to each other."""

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from drawbar.geometry import Floats
from drawbar.signals.quantities import Array, Metres, Radians, Ratio
from drawbar.signals.structs import as_struct
from drawbar.statuses import SolverStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyPlace:
    """Where one body is beside the path."""

    progress: Metres
    """arc length of the closest point"""
    lateral_error: Metres
    """of the body from the path, left positive"""
    closest: Annotated[Floats, Array(columns=4)]
    """the path at the closest point: x (m), y (m), yaw (rad, on any branch), curvature (1/m)"""


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyReference(BodyPlace):
    """The path as one body's controller sees it: the closest point and one sample for each stage."""

    samples: Annotated[Floats, Array(columns=4, rows="N + 1")]
    """x (m), y (m), yaw (rad, on the branch of the estimate), curvature (1/m) of each stage"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """References of both bodies at one instant, as controllers are given them."""

    time: float
    """s"""
    tractor: BodyReference
    trailer: BodyReference


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedPlace(BodyPlace):
    """Where one body is beside the path, and which point of the line its tracked point is beside."""

    line_x: Metres = math.nan
    """of the point of the line closest to the tracked point; that of `closest` unless `vehicle.tracked` is set"""
    line_y: Metres = math.nan


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Places:
    """Where both bodies are beside the path at one instant: references without samples, which follow from the path."""

    time: float
    """s"""
    tractor: RecordedPlace
    trailer: RecordedPlace


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class BodyPlan:
    """One nominal controller's answer."""

    steering: Radians
    """nominal steering to apply now"""
    poses: Annotated[Floats, Array(columns=3, rows="N + 1")]
    """predicted x (m), y (m), yaw (rad) of the body's point"""
    steerings: Annotated[Floats, Array(columns=0, rows="N")]
    """planned steering, rad"""
    deviation: Annotated[Floats, Array(columns=0, rows="deviations", counted=True)] = field(
        default_factory=lambda: np.zeros(0)
    )
    """x^ - x- in the error coordinates of this body's controller; empty where there is no nominal state"""
    status: SolverStatus


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """The nominal plans of both bodies at one instant."""

    time: float
    """s"""
    tractor: BodyPlan
    trailer: BodyPlan


@as_struct
@dataclass(frozen=True, slots=True, kw_only=True)
class BodySteering:
    """How one steering command came about: nominal plus ancillary, then clipped."""

    nominal: Radians
    """of the plan"""
    ancillary: Radians
    """K (x^ - x-)"""
    command: Radians
    """their sum within the bound"""
    margin: Ratio = math.nan
    """how far inside its tube the body is: 1 at its centre, 0 on its boundary, negative outside; NaN: none declared"""
    saturated: bool
    """the sum was beyond the bound"""
