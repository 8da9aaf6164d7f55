"""Planning a field's line: the pass beside it that is driven, made drivable, and how far that leaves it."""

from dataclasses import dataclass

import numpy as np

from drawbar.fields.field import Field
from drawbar.fields.lines import on_plane, pass_beside, with_ends
from drawbar.geometry import Floats
from drawbar.guidance.importers.line import RecordedLine
from drawbar.guidance.settings import LineLimits
from drawbar.guidance.smoothing import DrivablePath, make_drivable

NOTICED = 0.02
"""deviation that is drawn, m"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedPass:
    """A pass in the field's own frame."""

    line: RecordedLine
    drivable: DrivablePath

    @property
    def largest(self) -> float:
        """How far the driven line is at most from a point of the pass, m."""
        return float(self.drivable.deviations.max())

    @property
    def deviating(self) -> list[Floats]:
        """The stretches of the pass that the driven line leaves noticeably, each (n, 2) m."""
        far = self.drivable.deviations > NOTICED
        edges = np.flatnonzero(np.diff(far, prepend=False, append=False)).reshape(-1, 2)
        return [self.drivable.recorded[max(first - 1, 0) : last + 1] for first, last in edges.tolist()]


def plan_pass(
    field: Field,
    name: str,
    number: int,
    limits: LineLimits,
    *,
    width: float,
    offset: float,
) -> PlannedPass:
    """Return what will be driven.

    Args:
        field: of the line.
        name: of the line.
        number: of the pass, to the left of the line; 0 is the line itself.
        limits: of what is driven.
        width: of the implement, m.
        offset: of the implement, to the left, m.

    Raises:
        PathError: there is no such line or pass, or the vehicle cannot drive it.
    """
    frame = field.frame()
    ring = on_plane(field.boundary, frame) if field.boundary is not None else None
    line = on_plane(field.line(name).points, frame)
    points = _dense(with_ends(pass_beside(line, number, width=width, offset=offset), ring, name))
    called = name if number == 0 and offset == 0.0 else f"{name} {number:+d}"
    places = [f"{called}, point {index}" for index in range(1, len(points) + 1)]
    recorded = RecordedLine.checked(called, points, places)
    return PlannedPass(line=recorded, drivable=make_drivable(recorded, limits))


def _dense(points: Floats) -> Floats:
    """Return a straight line with points in between, so that it is not taken for a jump."""
    if len(points) != 2:
        return points
    count = max(int(np.hypot(*(points[1] - points[0])) / 10.0), 1)
    return np.linspace(points[0], points[1], count + 1)
