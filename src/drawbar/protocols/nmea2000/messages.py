"""Messages: the groups of a GNSS receiver on NMEA 2000, bytes to SI; what is not available is NaN."""

import math
import struct
from dataclasses import dataclass
from enum import IntEnum

from drawbar.protocols.isobus.fields import bits

POSITION_RAPID = 129025
COURSE_SPEED = 129026
GNSS_POSITION = 129029
HEADING = 127250
RATE_OF_TURN = 127251
ATTITUDE = 127257
_TRUE = 0
_NO_SID = 0xFD
"""from here on a sequence identifier joins nothing"""
_DAY = 86400.0


class FixMethod(IntEnum):
    """How a position was found."""

    NONE = 0
    SINGLE = 1
    DIFFERENTIAL = 2
    PRECISE = 3
    RTK_FIXED = 4
    RTK_FLOAT = 5
    ESTIMATED = 6
    MANUAL = 7
    SIMULATED = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class RapidPosition:
    """129025: WGS84, to 1.1 cm, without time and quality."""

    latitude: float
    """degrees, north positive"""
    longitude: float
    """degrees, east positive"""


@dataclass(frozen=True, slots=True, kw_only=True)
class GnssPosition:
    """129029: one position with its time and quality."""

    sid: int | None
    """joins messages of one epoch; None: none"""
    utc: float
    """seconds since 1970, to 0.1 ms; within a leap second those of the next day; NaN: not available"""
    latitude: float
    """degrees, WGS84, north positive"""
    longitude: float
    """degrees, WGS84, east positive"""
    altitude: float
    """above mean sea level, m"""
    geoid_separation: float
    """height of mean sea level above the ellipsoid, m"""
    method: int
    """a `FixMethod`, or a reserved number"""
    integrity: int
    """0: not checked, 1: safe, 2: caution, 3: unsafe"""
    satellites: int | None
    hdop: float
    pdop: float
    correction_age: float
    """of the first reference station, s"""
    station: int | None
    """number of the first reference station"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """129026: course and speed over ground."""

    sid: int | None
    course: float
    """direction of motion, counter-clockwise from east, rad; NaN where it is not to true north"""
    speed: float
    """over ground, m/s, never negative"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Heading:
    """127250: direction of the vehicle."""

    sid: int | None
    yaw: float
    """counter-clockwise from east, rad; NaN where it is not to true north"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """127251: rate of turn."""

    sid: int | None
    yaw_rate: float
    """counter-clockwise, rad/s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Attitude:
    """127257: attitude; its yaw has no reference and is left out."""

    sid: int | None
    pitch: float
    """nose up positive, rad"""
    roll: float
    """right side down positive, rad"""


def decode_rapid_position(data: bytes) -> RapidPosition | None:
    """Return a position of 129025; None where there are not 8 bytes."""
    if len(data) != 8:
        return None
    latitude, longitude = _signed(data, "<i", 0, 1e-7), _signed(data, "<i", 4, 1e-7)
    return RapidPosition(latitude=_within(latitude, 90.0), longitude=_within(longitude, 180.0))


def decode_gnss_position(data: bytes) -> GnssPosition | None:
    """Return a position of 129029; None where bytes are missing."""
    if len(data) < 43 or len(data) < 43 + 4 * data[42] * (data[42] < _NO_SID):
        return None
    stations = data[42] if data[42] < _NO_SID else 0
    return GnssPosition(
        sid=_sid(data),
        utc=_unsigned(data, "<H", 1, _DAY) + _within(_unsigned(data, "<I", 3, 1e-4), _DAY + 1.0),
        latitude=_within(_signed(data, "<q", 7, 1e-16), 90.0),
        longitude=_within(_signed(data, "<q", 15, 1e-16), 180.0),
        altitude=_signed(data, "<q", 23, 1e-6),
        geoid_separation=_signed(data, "<i", 38, 0.01),
        method=bits(data[31], 4, 4),
        integrity=bits(data[32], 0, 2),
        satellites=data[33] if data[33] < _NO_SID else None,
        hdop=_signed(data, "<h", 34, 0.01),
        pdop=_signed(data, "<h", 36, 0.01),
        correction_age=_unsigned(data, "<H", 45, 0.01) if stations else math.nan,
        station=data[43] >> 4 | data[44] << 4 if stations else None,
    )


def decode_motion(data: bytes) -> Motion | None:
    """Return course and speed of 129026; None where there are not 8 bytes."""
    if len(data) != 8:
        return None
    course = _unsigned(data, "<H", 2, 1e-4) if bits(data[1], 0, 2) == _TRUE else math.nan
    return Motion(sid=_sid(data), course=_from_east(course), speed=_unsigned(data, "<H", 4, 0.01))


def decode_heading(data: bytes) -> Heading | None:
    """Return the heading of 127250; None where there are not 8 bytes."""
    if len(data) != 8:
        return None
    heading = _unsigned(data, "<H", 1, 1e-4) if bits(data[7], 0, 2) == _TRUE else math.nan
    return Heading(sid=_sid(data), yaw=_from_east(heading))


def decode_turn(data: bytes) -> Turn | None:
    """Return the rate of turn of 127251; None where there are fewer than 5 bytes."""
    if len(data) < 5:
        return None
    return Turn(sid=_sid(data), yaw_rate=-_signed(data, "<i", 1, 1e-6 / 32.0))


def decode_attitude(data: bytes) -> Attitude | None:
    """Return pitch and roll of 127257; None where there are fewer than 7 bytes."""
    if len(data) < 7:
        return None
    return Attitude(sid=_sid(data), pitch=_signed(data, "<h", 3, 1e-4), roll=_signed(data, "<h", 5, 1e-4))


def _sid(data: bytes) -> int | None:
    return data[0] if data[0] < _NO_SID else None


def _unsigned(data: bytes, form: str, offset: int, resolution: float) -> float:
    """Return an unsigned field; the three largest numbers mean reserved, error and not available."""
    (raw,) = struct.unpack_from(form, data, offset)
    return raw * resolution if raw < (1 << 8 * struct.calcsize(form)) - 3 else math.nan


def _signed(data: bytes, form: str, offset: int, resolution: float) -> float:
    """Return a signed field; the three largest numbers mean reserved, error and not available."""
    (raw,) = struct.unpack_from(form, data, offset)
    return raw * resolution if raw < (1 << 8 * struct.calcsize(form) - 1) - 3 else math.nan


def _within(angle: float, largest: float) -> float:
    return angle if abs(angle) <= largest else math.nan


def _from_east(heading: float) -> float:
    """Return a direction clockwise from north as one counter-clockwise from east, within [-pi, pi)."""
    return (math.pi / 2 - heading + math.pi) % (2.0 * math.pi) - math.pi
