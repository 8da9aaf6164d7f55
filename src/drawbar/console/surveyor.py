"""Surveyor: where the tractor stands by its receiver, and the curve that is recorded while it is driven by hand."""

import math
from collections.abc import Callable

from drawbar.errors import PathError
from drawbar.fields.track import Track
from drawbar.geometry import arm_offset
from drawbar.messages import Fixes
from drawbar.signals import FixQuality
from drawbar.vehicle.parameters import Mast

_COURSE = 0.5
"""faster than this a receiver's course is the tractor's yaw, driving forward, m/s"""
FRESH = 1_000_000_000
"""a position older than this is none, ns"""


class Surveyor:
    """Takes the receivers' fixes; a curve continues to be recorded whether a page is open or not."""

    def __init__(self, mast: Mast, clock: Callable[[], int]) -> None:
        """Take where the tractor's antenna stands, and the monotonic clock in ns."""
        self._mast, self._clock = mast, clock
        self._fixes: Fixes | None = None
        self._yaw = math.nan
        self.track: Track | None = None
        """the curve that is being recorded; None: none is"""
        self.a: tuple[float, float] | None = None
        """point A, east and north in the drive's frame, m"""

    def receive_fixes(self, fixes: Fixes, yaw: float) -> None:
        """Take in fixes, with the tractor's yaw as far as the estimator knows it, rad; NaN: not now."""
        self._fixes = fixes
        self._yaw = yaw
        if not math.isfinite(yaw) and fixes.tractor_speed >= _COURSE:
            self._yaw = fixes.tractor_course
        if self.track is not None and (place := self._place()) is not None:
            self.track.add(*place)

    @property
    def place(self) -> tuple[float, float, float] | None:
        """The middle of the rear axle: east, north (m) and yaw (rad, NaN: not known); None: not known now."""
        place = self._place()
        return (*place, self._yaw) if place is not None else None

    def here(self) -> tuple[float, float]:
        """Return where the middle of the rear axle is, m; raises PathError where that is not known to centimetres."""
        place = self._place()
        if place is None:
            raise PathError("the tractor's receiver has no RTK-fixed position now; wait for one")
        return place

    def _place(self) -> tuple[float, float] | None:
        fixes = self._fixes
        if fixes is None or self._clock() - fixes.time > FRESH or fixes.tractor_quality != FixQuality.FIXED:
            return None
        if not math.isfinite(fixes.tractor_x + fixes.tractor_y):
            return None
        attitude = (fixes.tractor_roll - self._mast.roll_offset, fixes.tractor_pitch - self._mast.pitch_offset)
        roll, pitch = (each if math.isfinite(each) else 0.0 for each in attitude)
        if not math.isfinite(self._yaw):
            if self._mast.forward or self._mast.left:
                return None  # nobody knows where the axle is from there
            return fixes.tractor_x, fixes.tractor_y
        east, north = arm_offset(self._yaw, roll, pitch, self._mast.arm)
        return fixes.tractor_x - east, fixes.tractor_y - north
