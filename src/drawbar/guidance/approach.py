"""The way onto the path for a vehicle that faces away from it: three turns within the vehicle's limits (turns.py).

The turns are found beside a straight line, then laid along the path: a point of theirs is an arc length of the path and
a distance to its left. Beside a curved path they become a little tighter or wider by that.
"""

import math
from dataclasses import dataclass

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats, wrap
from drawbar.guidance.path import Complexes, Path
from drawbar.guidance.turns import Trace, TurnLimits, trace
from drawbar.signals import Pose

_STEPS = np.radians(7.5) * np.arange(-16, 17)
"""angles that the first and the last turn are tried with, rad"""
_ROUNDS = 2.0 * math.pi * np.array([-1.0, 0.0, 1.0])
_BISECTIONS = 40
_TIGHTER = 1.4
"""how much tighter than their limit turns may become where they are laid beside a curve"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Approach:
    """A track from where the tractor stands to the path."""

    track: Path
    joins_at: float
    """arc length of the path at the track's end, m"""

    def sample(self, path: Path, arc_length: Floats) -> Floats:
        """Return (n, 4) as Path.sample does, at arc lengths (n,) of the track, m; beyond its end those of the path."""
        beyond = arc_length - self.track.length
        on_path = path.sample(self.joins_at + beyond)
        return np.where(beyond[:, np.newaxis] > 0.0, on_path, self.track.sample(arc_length))


def find_approach(
    path: Path, pose: Pose, near: float, *, curvature: float, limits: TurnLimits, room: float
) -> Approach:
    """Return the shortest way onto the path that stays within the room beside it.

    Args:
        path: where to go.
        pose: of the tractor.
        near: arc length of the path beside the tractor, m.
        curvature: of the tractor's motion as its wheels stand, 1/m.
        limits: of the turns.
        room: how far from the path, on either side, the way may lead, m.

    Raises:
        PathError: there is no such way.
    """
    x, y, yaw, bend = path.sample(np.array([near]))[0].tolist()
    offset = math.cos(yaw) * (pose.y - y) - math.sin(yaw) * (pose.x - x)
    turned = wrap(pose.yaw - yaw)
    heading = math.atan2((1.0 - bend * offset) * math.sin(turned), math.cos(turned))
    straightened = trace(limits, np.zeros(0), heading=heading, curvature=curvature)
    start = offset + float(straightened.points[-1].imag)
    for angles in turns_onto_line(start, float(straightened.heading[-1]), limits):
        way = trace(limits, angles, heading=heading, curvature=curvature)
        if np.abs(offset + way.points.imag).max() <= max(room, abs(offset)):
            found = _laid(path, near, offset, way)
            bends = found.track.sample(found.track.anchors[1:])[:, 3]
            if np.abs(bends).max() <= _TIGHTER * limits.curvature:
                return found
    raise PathError(
        f"the tractor at ({pose.x:z.2f}, {pose.y:z.2f}) m faces {math.degrees(turned):.0f}° away from the path; turns "
        f"of {limits.curvature:g} 1/m and {limits.rate:g} 1/m² do not lead onto it within {room:g} m beside it: turn "
        f"the vehicle by hand, or raise guidance.turning_room or vehicle.curvature_limit"
    )


def turns_onto_line(offset: float, heading: float, limits: TurnLimits) -> Floats:
    """Return (n, 3): angles (rad) of three turns that lead onto a line, the shortest ways first.

    The first turn is a multiple of 7.5°; the last one is found by bisection, and the one between follows.

    Args:
        offset: of the vehicle from the line, left positive, m.
        heading: of the vehicle against the line, rad.
        limits: of the turns.
    """
    first, total, last = np.meshgrid(_STEPS, _ROUNDS - heading, _STEPS, indexing="ij")

    def end(first: Floats, total: Floats, last: Floats) -> Floats:
        """Return how far left of the line the turns end, m."""
        angles = _three(first, total, last)
        middle = heading + np.cumsum(angles, axis=-1) - 0.5 * angles
        left: Floats = offset + (limits.chord(angles) * np.sin(middle)).sum(axis=-1)
        return left

    side = np.sign(end(first, total, last))
    crossed = side[..., :-1] != side[..., 1:]
    first, total, side = (values[..., :-1][crossed] for values in (first, total, side))
    low, high = last[..., :-1][crossed], last[..., 1:][crossed]
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        same = np.sign(end(first, total, middle)) == side
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    angles = _three(first, total, low)
    shortest_first: Floats = angles[limits.length(angles).sum(axis=-1).argsort(kind="stable")]
    return shortest_first


def _three(first: Floats, total: Floats, last: Floats) -> Floats:
    """Return the angles (..., 3) of three turns from the first, their sum and the last one, rad."""
    return np.stack([first, total - first - last, last], axis=-1)


def _laid(path: Path, near: float, offset: float, way: Trace) -> Approach:
    """Lay a way that was found beside a straight line along the path from `near` (m) on."""
    along, left = near + way.points.real, offset + way.points.imag
    samples = path.sample(along)
    yaw = samples[:, 2]
    # the way ends in the path's direction; whole rounds before that are not the path's
    direction = way.heading - way.heading[-1]
    bent = np.arctan2(np.sin(direction), (1.0 - left * samples[:, 3]) * np.cos(direction))
    turned = yaw + np.unwrap(bent) - np.unwrap(bent)[-1]
    return Approach(
        track=_through(samples[:, 0] + 1j * (samples[:, 1] + left * np.exp(1j * yaw)), turned),
        joins_at=float(along[-1]),
    )


def _through(points: Complexes, yaw: Floats) -> Path:
    """Return the path through points (n,), m, with the continuous directions of motion yaw (n,), rad."""
    # from chord to arc
    lengths = np.abs(np.diff(points)) / np.sinc(0.5 * np.diff(yaw) / math.pi)
    return Path.through(
        arc_length=np.concatenate([[0.0], np.cumsum(lengths)]),
        x=points.real,
        y=points.imag,
        yaw=yaw,
        label_of_piece=np.zeros(len(lengths), dtype=np.int8),
        label_names=("approach",),
    )
