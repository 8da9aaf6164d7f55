"""A smooth way from where a body stands to the path: its first offset fades with the distance driven.

Without it a controller that is handed a far-off path steers to its limits, and the steering's rate limit then carries
the vehicle across (2 m off: more than a metre of overshoot).
"""

import math

import numpy as np

from drawbar.geometry import Floats

_FADED = 1e-4
"""share of the offset that counts as none"""


class Approach:
    """Shifts path samples sideways by offset · exp(-(s - start) / length)."""

    def __init__(self, *, start: float, offset: float, length: float) -> None:
        """Begin at arc length start (m) with the offset (m, left positive), fading over length (m)."""
        self._start, self._offset, self._length = start, offset, length
        self.end: float = start - length * math.log(_FADED)
        """arc length beyond which there is nothing left to bend, m"""

    def bend(self, arc_length: Floats, samples: Floats) -> None:
        """Move samples (n, 4: x, y, yaw, curvature) at arc lengths (n,), m, onto the approach, in place."""
        offset = self._offset * np.exp(np.minimum(self._start - arc_length, 0.0) / self._length)
        yaw = samples[:, 2]
        samples[:, 0] -= offset * np.sin(yaw)
        samples[:, 1] += offset * np.cos(yaw)
        samples[:, 2] -= np.arctan(offset / self._length)
        samples[:, 3] += offset / self._length**2
