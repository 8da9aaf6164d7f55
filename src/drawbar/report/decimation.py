"""Decimation of a long curve to fewer points that look the same: the lowest and highest value of each stretch stay."""

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats

POINTS = 3000
"""at most about so many points of a curve are drawn; more than any screen shows"""
POSES = 10_000
"""at most about so many points of a track are drawn"""

Indices = NDArray[np.intp]


def extremes(values: Floats) -> Indices:
    """Return which of the values (n,) to draw, ascending: all of a short curve, else the extremes of each stretch.

    The first, the last, the largest and the smallest value of each stretch, and a missing one (NaN) of each that has
    any are among them.
    """
    count = len(values)
    if count <= POINTS:
        return np.arange(count)
    size = -(-count // (POINTS // 3))
    rows = -(-count // size)
    padded = np.full(rows * size, np.nan)
    padded[:count] = values
    table = padded.reshape(rows, size)
    missing = np.isnan(table)
    first = np.arange(rows) * size
    kept = [
        first + np.where(missing, np.inf, table).argmin(axis=1),
        first + np.where(missing, -np.inf, table).argmax(axis=1),
        (first + missing.argmax(axis=1))[missing.any(axis=1)],
        np.array([0, count - 1]),
    ]
    indices = np.unique(np.concatenate(kept))
    return indices[indices < count]


def thinned(count: int) -> Indices:
    """Return at most about POSES of `count` indices at equal distances, the last one included."""
    return np.unique(np.append(np.arange(0, count, max(-(-count // POSES), 1)), max(count - 1, 0)))[:count]
