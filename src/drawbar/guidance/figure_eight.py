"""Figure-eights, the paper's track: straights and circular arcs (docs/theory/path.md)."""

import math
from collections.abc import Sequence

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats
from drawbar.guidance.path import PIECE_LENGTH, Path


def figure_eights(radii: Sequence[float], straight_length: float) -> Path:
    """Return the eights of the given radii (m), driven one after the other through the origin, heading east.

    Each eight is half a straight, a left arc, a whole straight through the crossing, a right arc and half a
    straight; straight_length (m) is the one between two tangent points. Classes are "straight" and the
    curvature in 1/m, as in "0.125". Raises PathError unless all lengths are positive and finite.
    """
    for name, value in [*(("radius", radius) for radius in radii), ("straight length", straight_length)]:
        if not 0.0 < value < math.inf:
            raise PathError(f"figure-eight: {name} is {value} m; it must be a positive, finite length")
    if not radii:
        raise PathError("figure-eight: no radius was given; give at least one, in m")
    names = ("straight", *dict.fromkeys(f"{1.0 / radius:.3g}" for radius in radii))
    steps = [piece for radius in radii for piece in _one_eight(radius, straight_length)]
    lengths, curvatures = (np.concatenate(column) for column in zip(*steps, strict=True))
    labels = [names.index(f"{abs(curvature):.3g}") if curvature else 0 for curvature in curvatures]
    x, y, yaw = _drive(lengths, curvatures)
    return Path.through(
        arc_length=np.concatenate([[0.0], np.cumsum(lengths)]),
        x=x,
        y=y,
        yaw=yaw,
        label_of_piece=np.array(labels, dtype=np.int8),
        label_names=names,
    )


def _one_eight(radius: float, straight_length: float) -> list[tuple[Floats, Floats]]:
    """Return lengths (m) and curvatures (1/m) of the pieces of each of the five parts of one eight."""
    half = 0.5 * straight_length
    # seen from the crossing, the circle's centre lies atan(radius / half) beside the straight
    arc = radius * (math.pi + 2.0 * math.atan2(radius, half))
    parts = [(half, 0.0), (arc, 1.0 / radius), (straight_length, 0.0), (arc, -1.0 / radius), (half, 0.0)]
    return [_divide(length, curvature) for length, curvature in parts]


def _divide(length: float, curvature: float) -> tuple[Floats, Floats]:
    """Return lengths (m) and curvatures (1/m) of equal pieces of an arc, each at most PIECE_LENGTH."""
    count = math.ceil(length / PIECE_LENGTH)
    return np.full(count, length / count), np.full(count, curvature)


def _drive(lengths: Floats, curvatures: Floats) -> tuple[Floats, Floats, Floats]:
    """Return x, y (m) and yaw (rad), each (n+1,), at the ends of n arcs, from the origin heading east."""
    yaw = np.concatenate([[0.0], np.cumsum(lengths * curvatures)])
    middle = 0.5 * (yaw[:-1] + yaw[1:])
    chords = lengths * np.sinc(0.5 * lengths * curvatures / math.pi)
    x = np.concatenate([[0.0], np.cumsum(chords * np.cos(middle))])
    y = np.concatenate([[0.0], np.cumsum(chords * np.sin(middle))])
    return x, y, yaw
