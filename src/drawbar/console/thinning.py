"""Thinning: few enough points that a line looks as it is wherever one looks closely. Pure."""

import numpy as np
import shapely
from numpy.typing import NDArray

from drawbar.geometry import Floats


def kept_points(points: Floats, tolerance: float, most: int) -> NDArray[np.intp]:
    """Return which points of a line are enough to stay within a tolerance of all of them.

    Args:
        points: (n, 2) m.
        tolerance: m; a larger one counts where otherwise more points than `most` were left.
        most: points.
    """
    if len(points) < 3:
        return np.arange(len(points))
    line = shapely.LineString(np.column_stack([points, np.arange(len(points))]))  # heights do not count
    while True:
        kept = shapely.get_coordinates(line.simplify(tolerance, preserve_topology=False), include_z=True)[:, 2]
        if len(kept) <= most:
            indices: NDArray[np.intp] = kept.astype(np.intp)
            return indices
        tolerance *= 2.0
