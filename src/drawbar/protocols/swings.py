"""Swings: an angle that is away and back again sooner than a wheel turns, as of two devices at one address."""

import math

_SWING = math.radians(2.0)
"""by which an angle that is there and back again within three reports has been away: no wheel is so quick, rad"""


class Swings:
    """How often an angle was away and back again within three reports."""

    def __init__(self) -> None:
        self.count = 0
        self.in_a_row = 0
        """with the last report and those just before it; a single outlier is one"""
        self._last = self._before = math.nan

    def see(self, angle: float) -> None:
        """Take in an angle, rad; NaN: none was measured."""
        swings = abs(self._last - angle) > _SWING > 2.0 * abs(self._before - angle)
        self.count += swings
        self.in_a_row = self.in_a_row + 1 if swings else 0
        self._before, self._last = self._last, angle

    def forget(self) -> None:
        """Do not compare what comes with what was before: there was a gap."""
        self._before = self._last = math.nan
