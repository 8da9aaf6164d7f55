"""New lines of a field: A-B, A and heading, and passes beside a line. On a plane, in m; angles in rad, ENU."""

import math
from pathlib import Path

import numpy as np
import shapely

from drawbar.errors import PathError
from drawbar.geometry import Floats, LocalFrame
from drawbar.guidance.importers.boundary import Boundary

AHEAD = 100.0
"""between A and the point that stands for B where only a heading is given; an A-B line goes so far on where no boundary
ends it, m"""
_SHORTEST = 1.0
"""between A and B, m"""
_WIDEST, _FARTHEST = 60.0, 2000.0
"""m"""
_ARCS = 24
"""pieces of a quarter circle where a pass goes round a corner"""
_DENSE = 1.0
"""longest piece of a curve before it is shifted, m"""
_BESIDE = 0.1
"""places at most so much nearer to a curve than its pass belong to the pass, m ..."""
_COVERED = 0.3
"""... and are on it where they are no farther from it, m"""
_LOST = 2.0
"""of a curve that may be without a pass though it is not too tight there, m"""


def from_a_and_b(a: Floats, b: Floats) -> Floats:
    """Return the A-B line (2, 2) through two points (2,), m; raises PathError where they are too close."""
    if not float(np.hypot(*(b - a))) >= _SHORTEST:
        raise PathError(
            f"A and B are {np.hypot(*(b - a)):.2f} m apart; {_SHORTEST:g} m are needed: drive on, then set B"
        )
    return np.array([a, b])


def from_a_and_heading(a: Floats, compass: float) -> Floats:
    """Return the A-B line (2, 2) through a point (2,) m along a compass heading, clockwise from north, rad.

    Raises:
        PathError: the heading is not finite.
    """
    if not math.isfinite(compass):
        raise PathError(f"the heading is {compass}; give degrees from 0 (north) to 360, clockwise")
    return np.array([a, a + AHEAD * np.array([math.sin(compass), math.cos(compass)])])


def pass_beside(line: Floats, number: int, *, width: float, offset: float) -> Floats:
    """Return the pass so many widths to the left of a line (right: negative), (n, 2) m, in the line's direction.

    A curve's pass has no loops where the curve is tighter than the distance: that part falls away. Beside a curve that
    crosses itself a pass would lack more.

    Args:
        line: (n, 2) m.
        number: 0 is the line itself, moved by the offset.
        width: of the implement, m.
        offset: of the implement, or of the line, to the left, m.

    Raises:
        PathError: a number is not allowed, or of the line at this distance nothing is left, or not all that should be.
    """
    if not 0.1 <= width <= _WIDEST:
        raise PathError(f"the working width is {width} m; 0.1 to {_WIDEST:g} m are allowed")
    if not abs(offset) <= _WIDEST:
        raise PathError(f"the offset is {offset} m; at most {_WIDEST:g} m to either side are allowed")
    distance = number * width + offset
    if not abs(distance) <= _FARTHEST:
        raise PathError(f"pass {number} is {distance:.0f} m beside the line; at most {_FARTHEST:g} m are allowed")
    if distance == 0.0:
        return line
    if len(line) == 2:
        ahead = (line[1] - line[0]) / np.hypot(*(line[1] - line[0]))
        moved: Floats = line + distance * np.array([-ahead[1], ahead[0]])
        return moved
    dense = shapely.segmentize(shapely.LineString(line), _DENSE)
    beside = shapely.offset_curve(dense, distance, quad_segs=_ARCS, join_style="round")
    pieces = [piece for piece in shapely.get_parts(beside) if not piece.is_empty]
    if not pieces:
        raise PathError(f"nothing is left of the line at {distance:.1f} m beside it; it is curved too tightly there")
    longest = max(pieces, key=shapely.length)
    if not (lost := _lost(dense, longest, distance)) <= _LOST:
        raise PathError(
            f"{lost:.0f} m of the line would have no pass at {distance:.1f} m beside it, since it crosses itself or "
            f"comes back to itself; take a smaller distance, or divide the line"
        )
    points: Floats = shapely.get_coordinates(longest)
    return points


def _lost(curve: shapely.LineString, beside: shapely.LineString, distance: float) -> float:
    """Return how much of a curve is without its pass, though no other part of it is nearer to the pass's place, m."""
    points = shapely.get_coordinates(curve)
    steps = np.diff(points, axis=0)
    lengths = np.hypot(*steps.T)
    steps, lengths, middles = (each[lengths > 0.0] for each in (steps, lengths, (points[1:] + points[:-1]) / 2.0))
    left = np.column_stack([-steps[:, 1], steps[:, 0]]) / lengths[:, None]
    places = shapely.points(middles + distance * left)
    shapely.prepare([curve, beside])
    near = shapely.dwithin(curve, places, abs(distance) - _BESIDE) | shapely.dwithin(beside, places, _COVERED)
    return float(lengths[~near].sum())


def with_ends(line: Floats, ring: Floats | None, source: str) -> Floats:
    """Return what is driven of a line, (n, 2) m: an A-B line from boundary to boundary, or so far on; a curve as it is.

    Args:
        line: (n, 2) m.
        ring: (m, 2) of the field's boundary, m; None: there is none.
        source: the line's name, for errors.

    Raises:
        PathError: the line is too short to have a direction, or does not cross the field.
    """
    if len(line) != 2:
        return line
    length = float(np.hypot(*(line[1] - line[0])))
    if not length >= _SHORTEST:
        raise PathError(f"line {source!r}: A and B are {length:.2f} m apart; {_SHORTEST:g} m are needed")
    ahead = (line[1] - line[0]) / length
    if ring is None:
        return np.array([line[0], line[1] + AHEAD * ahead])
    ends = Boundary(source=Path(source), ring=ring).chord(line[0], ahead, f"line {source!r}")
    return np.array([line[0] + end * ahead for end in ends])


def on_plane(points: Floats, frame: LocalFrame) -> Floats:
    """Return WGS84 degrees (n, 2) as points of a frame, (n, 2) m."""
    return np.column_stack(frame.east_north(points[:, 0], points[:, 1]))


def on_earth(points: Floats, frame: LocalFrame) -> Floats:
    """Return points of a frame, (n, 2) m, as WGS84 degrees (n, 2)."""
    return np.column_stack(frame.level(points[:, 0], points[:, 1]))
