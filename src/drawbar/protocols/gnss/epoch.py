"""An epoch: all that a receiver reports for one instant, in SI."""

import datetime
import math
from dataclasses import dataclass

from drawbar.signals import FixQuality


@dataclass(frozen=True, slots=True, kw_only=True)
class Epoch:
    """One measurement of a receiver. Missing values are NaN or None; angles as in `messages.py`."""

    time: float
    """monotonic instant of the measurement, s"""
    received: float
    """monotonic instant of its first byte, s"""
    utc: float
    """its own time, seconds of the UTC day; 86400 and more in a leap second"""
    day: datetime.date | None = None
    """of UTC, in epochs that have it"""
    latitude: float = math.nan
    """of the antenna, WGS84 degrees; missing without a fix to drive by"""
    longitude: float = math.nan
    """degrees"""
    height: float = math.nan
    """above the ellipsoid, m"""
    quality: FixQuality = FixQuality.UNKNOWN
    """worst of the last `quality_hold` seconds; UNKNOWN: the receiver reports no position at all"""
    reported: FixQuality = FixQuality.UNKNOWN
    """quality of this epoch alone"""
    sigma_east: float = math.nan
    """standard deviation, inflated, at least 1 cm, m"""
    sigma_north: float = math.nan
    """m"""
    resolution: float = 0.0
    """what the last digit of latitude or longitude is worth, degrees"""
    speed: float = math.nan
    """over ground, m/s, never negative"""
    course: float = math.nan
    """yaw of the velocity, rad; missing below 0.3 m/s"""
    yaw: float = math.nan
    """of the body, by two antennas whose ambiguities are fixed, rad"""
    roll: float = math.nan
    """right side down positive, rad"""
    pitch: float = math.nan
    """front down positive, rad"""
    inertial_yaw: float = math.nan
    """of an inertial sensor, from any zero, drifting: for differences over short times only, rad"""
    yaw_rate: float = math.nan
    """of the body, counter-clockwise, rad/s"""
    attitude_age: float = 0.0
    """of roll, pitch and yaw rate at `time`, s"""
    correction_age: float = math.nan
    """s; the oldest possible where the receiver gives a class only"""
    station: int | None = None
    """of the corrections; a change means another base, and a jump"""
    satellites: int | None = None
    hdop: float = math.nan

    @property
    def has_fix(self) -> bool:
        """Whether there is a position."""
        return math.isfinite(self.latitude + self.longitude)
