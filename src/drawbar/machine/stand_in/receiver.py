"""Receiver's stand-in: what it would send at one instant, in each protocol, from what it is to report."""

import datetime
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from drawbar.errors import HardwareError
from drawbar.geometry import wrap
from drawbar.protocols.gnss.solution import SIGMA
from drawbar.signals import FixQuality


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """What a receiver is to report of one instant; a missing value is NaN."""

    time: datetime.datetime
    """UTC, sent to the millisecond"""
    latitude: float
    """of the antenna, WGS84 degrees"""
    longitude: float
    """degrees"""
    height: float
    """above the ellipsoid, m"""
    quality: FixQuality = FixQuality.FIXED
    sigma_east: float = 0.01
    """standard deviation, m"""
    sigma_north: float = 0.01
    """standard deviation, m"""
    speed: float = 0.0
    """over ground, m/s"""
    course: float = math.nan
    """yaw of the velocity, rad"""
    yaw: float = math.nan
    """of the line between the antennas, rad"""
    roll: float = math.nan
    """right side down positive, rad"""
    pitch: float = math.nan
    """front down positive, rad"""
    attitude_sigma: float = 0.005
    """standard deviation of yaw, roll and pitch, rad"""
    inertial_yaw: float = math.nan
    """of an inertial sensor, from any zero, rad"""
    yaw_rate: float = math.nan
    """counter-clockwise, rad/s"""
    heading_is_fixed: bool = True
    baseline: float = 1.0
    """distance of the antennas, m"""
    correction_age: float = 1.0
    """s"""
    station: int = 0
    satellites: int = 20

    def __post_init__(self) -> None:
        finite = (self.latitude, self.longitude, self.height, self.sigma_east, self.sigma_north, self.speed)
        if self.quality is FixQuality.UNKNOWN or not math.isfinite(sum(finite)):
            raise HardwareError(
                f"a receiver's stand-in was to report {self}; position, deviations and speed must be finite numbers "
                f"and the quality known: use FixQuality.NONE for a lost fix"
            )

    @property
    def has_fix(self) -> bool:
        """Whether there is a position to send."""
        return self.quality is not FixQuality.NONE


def of_quality(report: Report, quality: FixQuality) -> Report:
    """Return a report with another quality, and the standard deviation that goes with it."""
    sigma = SIGMA.get(quality, report.sigma_east)  # without a fix none is sent
    return replace(report, quality=quality, sigma_east=sigma, sigma_north=sigma)


def turned(report: Report, line: float) -> Report:
    """Return a report whose attitude is that of a line at an angle (rad) to the body's forward direction."""
    sine, cosine = math.sin(line), math.cos(line)
    return replace(
        report,
        yaw=wrap(report.yaw + line),
        roll=report.roll * cosine + report.pitch * sine if line else report.roll,
        pitch=report.pitch * cosine - report.roll * sine if line else report.pitch,
    )


def heading(yaw: float) -> float:
    """Return a yaw (rad, counter-clockwise from east) in degrees clockwise from north, [0, 360)."""
    return (90.0 - math.degrees(yaw)) % 360.0


Encoder = Callable[[Report], list[bytes]]
"""frames of one epoch in the order in which they are sent"""
