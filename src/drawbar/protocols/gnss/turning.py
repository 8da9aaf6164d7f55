"""Turning of the body: the yaw rate that its receiver reports, else that of an inertial sensor since the last epoch.

Boards with such a sensor report its yaw, to 0.1°, and no yaw rate that could be relied on.
"""

import math

from drawbar.geometry import wrap
from drawbar.protocols.gnss.timing import difference

LARGEST_YAW_RATE = math.radians(100.0)
"""no vehicle turns faster, rad/s"""
_LONGEST = 0.3
"""between two epochs whose difference is a rate, s"""


class Turning:
    """Remembers the yaw of the inertial sensor in the last epoch."""

    def __init__(self) -> None:
        self._yaw, self._utc = math.nan, math.nan

    def rate(self, reported: float, inertial_yaw: float, utc: float) -> tuple[float, float]:
        """Return an epoch's yaw rate (rad/s, NaN: not known) and how old it is (s), half the time between two yaws.

        Args:
            reported: by the receiver, rad/s, NaN: not reported.
            inertial_yaw: from any zero, rad, NaN: not known.
            utc: of the epoch, later than of those before, seconds of the UTC day.
        """
        turned, passed = wrap(inertial_yaw - self._yaw), difference(utc, self._utc)
        self._yaw, self._utc = inertial_yaw, utc
        if math.isfinite(reported):
            return reported, 0.0
        return (turned / passed, passed / 2.0) if math.isfinite(turned) and passed <= _LONGEST else (math.nan, 0.0)
