"""Messages of a receiver: the content of one frame, in SI; a few kinds of content, whatever the protocol was.

Angles are rad; yaw counts counter-clockwise from east; roll is right side down and pitch front down positive. Latitude
and longitude alone stay WGS84 degrees, as everywhere outside the local frame. A missing value is NaN or None.
"""

import datetime
import math
from dataclasses import dataclass

from drawbar.signals import FixQuality

DAY = 86400.0
"""s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Position:
    """Where the antenna is."""

    latitude: float = math.nan
    """degrees"""
    longitude: float = math.nan
    """degrees"""
    height: float = math.nan
    """above the ellipsoid, m"""
    altitude: float = math.nan
    """above the geoid, m"""
    separation: float = math.nan
    """of the geoid from the ellipsoid, m"""
    quality: FixQuality = FixQuality.UNKNOWN
    """UNKNOWN: not in this message"""
    code: int | None = None
    """the quality in the protocol's own number"""
    satellites: int | None = None
    hdop: float = math.nan
    correction_age: float = math.nan
    """s"""
    station: int | None = None
    """of the corrections"""
    resolution: float = 0.0
    """what the last digit of latitude or longitude is worth, the coarser one, degrees"""
    rank: int = 0
    """of several positions of one epoch the highest is taken"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Velocity:
    """How the antenna moves over the ground."""

    speed: float = math.nan
    """m/s, never negative"""
    course: float = math.nan
    """yaw of the velocity, rad; missing at standstill"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Accuracy:
    """Standard deviations of the position, as the receiver reports them."""

    east: float = math.nan
    """m"""
    north: float = math.nan
    """m"""
    up: float = math.nan
    """m"""
    major: float = math.nan
    """half axis of the ellipse of one standard deviation, m"""
    minor: float = math.nan
    """m"""
    orientation: float = math.nan
    """yaw of the major axis, rad"""
    impossible: bool = False
    """a horizontal deviation is given, but is not above zero and finite"""
    rank: int = 0
    """of several accuracies of one epoch the highest is taken"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Attitude:
    """How the line between two antennas, or a body with an inertial sensor, stands."""

    yaw: float = math.nan
    """rad"""
    roll: float = math.nan
    """rad"""
    pitch: float = math.nan
    """rad"""
    baseline: float = math.nan
    """distance of the two antennas as measured, m"""
    fixed: bool | None = None
    """whether the ambiguities between the antennas are resolved; None: not in this message"""
    valid: bool = True
    """False: the receiver reports that there is no attitude"""
    code: int | None = None
    """the quality in the protocol's own number"""
    satellites: int | None = None
    correction_age: float = math.nan
    """of the line's own corrections, s"""
    rank: int = 0
    """of several attitudes of one epoch the highest is taken"""


@dataclass(frozen=True, slots=True, kw_only=True)
class InertialAttitude:
    """What an inertial sensor at the receiver measures: a yaw that counts from anywhere and drifts."""

    yaw: float = math.nan
    """rad, relative"""
    roll: float = math.nan
    """rad"""
    pitch: float = math.nan
    """rad"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """How fast the body turns."""

    yaw_rate: float
    """rad/s, counter-clockwise"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Date:
    """The day of the epoch, UTC."""

    day: datetime.date


@dataclass(frozen=True, slots=True, kw_only=True)
class Latency:
    """How long the receiver took from the epoch to the first byte, as it reports itself."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Spoofing:
    """Whether the receiver takes the signals for false ones, which somebody sends to mislead it."""

    suspected: bool


Content = Position | Velocity | Accuracy | Attitude | InertialAttitude | Turn | Date | Latency | Spoofing


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """One decoded frame."""

    kind: str
    """name of the sentence, block or message"""
    utc: float | None
    """time of its epoch in seconds of the UTC day, [86400, 86401) in a leap second; None: it carries none"""
    contents: tuple[Content, ...]
