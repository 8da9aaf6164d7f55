"""Surveyor: where the tractor stands by its receiver, and the curve that is recorded while it is driven by hand."""

import math
from collections.abc import Callable

import numpy as np

from drawbar.errors import PathError
from drawbar.fields.track import Track
from drawbar.geometry import Floats, arm_offset, wrap
from drawbar.messages import Fixes
from drawbar.signals import FixQuality
from drawbar.vehicle.parameters import Mast

_COURSE = 0.5
"""faster than this a receiver's course is its antenna's direction of motion, m/s"""
_AHEAD = 0.1
"""an antenna that moves at least so far ahead of the rear axle pulls it behind itself, m"""
_PULL = 0.3
"""how far behind a slow antenna a point follows it, whose direction is that of its motion, m"""
_STEP = 0.05
"""an antenna has moved once it is so far from where it was, m; less is noise"""
FRESH = 1_000_000_000
"""a position older than this is none, ns"""


class Surveyor:
    """Takes the receivers' fixes; a curve continues to be recorded whether a page is open or not."""

    def __init__(self, mast: Mast, wheelbase: float, clock: Callable[[], int]) -> None:
        """Take where the tractor's antenna stands, its wheelbase (m), and the monotonic clock in ns."""
        self._mast, self._wheelbase, self._clock = mast, wheelbase, clock
        self._fixes: Fixes | None = None
        self._yaw = math.nan
        self._moved_from = np.full(2, math.nan)
        """where the antenna was at its last motion, upright, m"""
        self.track: Track | None = None
        """the curve that is being recorded; None: none is"""
        self.a: tuple[float, float] | None = None
        """point A, east and north in the drive's frame, m"""

    def receive_fixes(self, fixes: Fixes, yaw: float, steering: float) -> None:
        """Take in fixes, the estimated yaw and the measured wheel angle, rad; NaN: unknown."""
        known = self._yaw if self._antenna() is not None else math.nan  # after a gap it may face anywhere
        self._fixes = fixes
        self._yaw = yaw if math.isfinite(yaw) else self._followed(known, steering if math.isfinite(steering) else 0.0)
        moved = self._upright(self._yaw)
        if math.isfinite(yaw) or not math.dist(moved, self._moved_from) < _STEP:
            self._moved_from = moved
        if self.track is not None and (place := self._place()) is not None:
            self.track.add(*place)

    def _followed(self, known: float, steering: float) -> float:
        """Return the yaw by how the antenna has moved; known: it was so before, rad.

        The axle's middle moves along the yaw alone, at any speed: an antenna that moves ahead of it pulls it behind
        itself. Any other antenna swings aside in curves, computed from the measured wheel angle.
        """
        fixes, (forward, left, _) = self._fixes, self._mast.arm
        if fixes is None or self._antenna() is None:
            return math.nan
        curvature = math.tan(steering) / self._wheelbase
        swing = math.atan2(curvature * forward, 1.0 - curvature * left)
        fast = fixes.tractor.speed >= _COURSE
        if not math.isfinite(known):
            turned = swing + (math.pi if fixes.wheel_speed < 0.0 else 0.0)
            return wrap(fixes.tractor.course - turned) if fast else math.nan
        east, north = self._upright(known) - self._moved_from
        if math.hypot(east, north) < _STEP:
            return known
        reverses = east * math.cos(known) + north * math.sin(known) < 0.0
        if (-forward if reverses else forward) >= _AHEAD:
            return self._pulled(known, east, north)
        turned = swing + (math.pi if reverses else 0.0)
        behind = _PULL * math.cos(known + turned), _PULL * math.sin(known + turned)
        direction = fixes.tractor.course if fast else math.atan2(north + behind[1], east + behind[0])
        return wrap(direction - turned)

    def _pulled(self, known: float, east: float, north: float) -> float:
        """Return the yaw after the antenna has pulled the axle so far east and north, m; known: before, rad."""
        forward, left, _ = self._mast.arm
        arm = np.add((east, north), arm_offset(known, 0.0, 0.0, (forward, left, 0.0)))
        ahead = float(arm @ arm) - left * left
        if not ahead > 0.0:
            return known
        return wrap(math.atan2(arm[1], arm[0]) - math.atan2(left, math.copysign(math.sqrt(ahead), forward)))

    def _upright(self, yaw: float) -> Floats:
        """Return where the antenna would be if the tractor did not lean, m."""
        flat = arm_offset(yaw, 0.0, 0.0, self._mast.arm)
        return np.add(self._antenna() or (math.nan, math.nan), flat) - self._arm(yaw)

    @property
    def place(self) -> tuple[float, float, float] | None:
        """The middle of the rear axle: east, north (m) and yaw (rad, NaN: not known); None: not known now."""
        place = self._place()
        return (*place, self._yaw) if place is not None else None

    @property
    def shown(self) -> tuple[float, float, float] | None:
        """The same for drawing: where the yaw is not known, as if both bodies were in one line; None: not known now."""
        antenna, fixes = self._antenna(), self._fixes
        if antenna is None or fixes is None or math.isfinite(self._yaw):
            return self.place
        yaw = math.atan2(antenna[1] - fixes.trailer.y, antenna[0] - fixes.trailer.x)
        east, north = self._arm(yaw)
        return (antenna[0] - east, antenna[1] - north, yaw) if math.isfinite(yaw) else None

    @property
    def is_fixed(self) -> bool:
        """Whether the antenna's position is known to centimetres."""
        return self._antenna() is not None

    def here(self) -> tuple[float, float]:
        """Return where the middle of the rear axle is, m; raises PathError where that is not known to centimetres."""
        if not self.is_fixed:
            raise PathError("the tractor's receiver has no RTK-fixed position now; wait for one")
        place = self._place()
        if place is None:
            raise PathError(
                "the antenna is not above the rear axle, and where the tractor faces is not known; drive on"
            )
        return place

    def _antenna(self) -> tuple[float, float] | None:
        """Return where the antenna is, m."""
        fixes = self._fixes
        if fixes is None or self._clock() - fixes.time > FRESH or fixes.tractor.quality != FixQuality.FIXED:
            return None
        place = fixes.tractor.x, fixes.tractor.y
        return place if math.isfinite(sum(place)) else None

    def _arm(self, yaw: float) -> tuple[float, float]:
        """Return how far east and north of the axle the antenna stands, m."""
        fixes = self._fixes
        attitude = (0.0, 0.0) if fixes is None else (fixes.tractor.roll, fixes.tractor.pitch)
        offsets = self._mast.roll_offset, self._mast.pitch_offset
        roll, pitch = (
            each - offset if math.isfinite(each) else 0.0 for each, offset in zip(attitude, offsets, strict=True)
        )
        return arm_offset(yaw, roll, pitch, self._mast.arm)

    def _place(self) -> tuple[float, float] | None:
        antenna = self._antenna()
        if antenna is None or not math.isfinite(self._yaw):
            above = not (self._mast.forward or self._mast.left)
            return antenna if above else None  # else the axle's place from there is unknown
        east, north = self._arm(self._yaw)
        return antenna[0] - east, antenna[1] - north
