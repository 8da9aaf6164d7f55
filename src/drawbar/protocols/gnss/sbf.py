"""SBF of Septentrio: PVTGeodetic, PosCovGeodetic, AttEuler, BaseVectorGeod, and RFStatus.

The library leaves latitude in rad and course in degrees, and passes do-not-use values on: -2e10, 65535, 255, and the
65535 that it has scaled. Blocks are taken with error 0 only.
"""

import math
from collections.abc import Callable
from typing import Any

from drawbar.protocols.gnss.messages import (
    Accuracy,
    Attitude,
    Content,
    Latency,
    Position,
    Spoofing,
    Turn,
    Velocity,
)
from drawbar.protocols.gnss.values import Values, place
from drawbar.signals import FixQuality

_QUALITIES = {
    1: FixQuality.SINGLE,
    2: FixQuality.DIFFERENTIAL,
    4: FixQuality.FIXED,
    5: FixQuality.FLOAT,
    6: FixQuality.DIFFERENTIAL,
    7: FixQuality.FIXED,
    8: FixQuality.FLOAT,
}
"""by type of solution; fixed location (3) and PPP (10) are no fix to drive by"""
_MOVING_BASE_FIXED, _MOVING_BASE_FLOAT = 7, 8
_ATTITUDE_FIXED = (2, 4)
_LONGEST_LATENCY = 1.0
"""s, as in a configuration"""
_LONGEST_BASELINE = 100.0
"""from a moving base, on the same vehicle, m"""
_NO_FLOAT = -2e10
_NO_INTEGER = {"NrSV": 255, "ReferenceID": 65535, "MeanCorrAge": 655.35, "HAccuracy": 655.35, "Latency": 6.5535}

_ENDS = {"Latency": 90, "HAccuracy": 92}
"""where fields end that revision 2 of PVTGeodetic brought; the library makes 0 of what older receivers do not send"""


def given(fields: dict[str, Any], length: int) -> dict[str, Any]:
    """Return the fields that hold a value in a block of a length (bytes)."""
    return {
        name: value for name, value in fields.items() if length >= _ENDS.get(name, 0) and not _is_unused(name, value)
    }


def _is_unused(name: str, value: Any) -> bool:
    if isinstance(value, float) and value == _NO_FLOAT:
        return True
    none = _NO_INTEGER.get(name)
    return none is not None and isinstance(value, int | float) and abs(value - none) < 1e-6


def pvt_geodetic(values: Values) -> tuple[Content, ...]:
    """Return position and velocity; HAccuracy is twice the root of both variances."""
    latitude, longitude = place(
        values.number("Latitude", 180.0 / math.pi, low=-math.pi / 2.0, high=math.pi / 2.0),
        values.number("Longitude", 180.0 / math.pi, low=-math.pi, high=math.pi),
    )
    code = values.integer("Type")
    error, flat = values.integer("Error"), values.integer("2D")
    height, separation = values.number("Height", low=-1e4, high=1e5), values.number("Undulation")
    position = Position(
        latitude=latitude,
        longitude=longitude,
        height=height,
        altitude=height - separation,
        separation=separation,
        quality=FixQuality.NONE if error or flat else _QUALITIES.get(code or 0, FixQuality.NONE),
        code=code,
        satellites=values.integer("NrSV"),
        correction_age=values.correction_age("MeanCorrAge"),
        station=values.integer("ReferenceID"),
        resolution=1e-12,
        rank=3,
    )
    speed, course = values.velocity("Vn", "Ve")
    axis = values.deviation("HAccuracy") / (2.0 * math.sqrt(2.0))
    latency = values.number("Latency", low=0.0, high=_LONGEST_LATENCY)
    return (
        position,
        Velocity(speed=speed, course=course),
        Accuracy(east=axis, north=axis, impossible=axis <= 0.0, rank=0),
        *(() if math.isnan(latency) else (Latency(seconds=latency),)),
    )


def pos_cov_geodetic(values: Values) -> tuple[Content, ...]:
    """Return the standard deviations of the position."""
    if values.integer("Error"):
        return ()
    north, east, up = (values.deviation(f"Cov_{axis}") for axis in ("latlat", "lonlon", "hgthgt"))
    impossible = north <= 0.0 or east <= 0.0
    return (Accuracy(east=_root(east), north=_root(north), up=_root(up), impossible=impossible, rank=2),)


def att_euler(values: Values) -> tuple[Content, ...]:
    """Return heading, pitch (front up) and roll of the antennas' line or plane, and how fast the heading changes."""
    mode = values.integer("Mode")
    attitude = Attitude(
        yaw=values.yaw("Heading"),
        roll=values.angle("Roll"),
        pitch=-values.angle("Pitch"),
        fixed=mode in _ATTITUDE_FIXED,
        valid=bool(mode) and values.integer("Error") == 0,
        code=mode,
        rank=3,
    )
    turn = Turn(yaw_rate=values.number("HeadingDot", -math.radians(1.0)))
    return (attitude, turn) if attitude.valid and attitude.fixed else (attitude,)


def base_vector_geod(values: Values) -> tuple[Content, ...]:
    """Return the line to this antenna from a moving base, if there is one; a fixed base gives no attitude."""
    code = values.integer("Type_01")
    if values.integer("N") != 1 or code not in (_MOVING_BASE_FIXED, _MOVING_BASE_FLOAT):
        return ()
    east, north, up = (values.number(f"Delta{axis}_01") for axis in ("East", "North", "Up"))
    length = math.hypot(east, north, up)
    if not 0.0 < length <= _LONGEST_BASELINE:
        values.refuse("base vector")
        return ()
    attitude = Attitude(
        yaw=math.atan2(north, east),
        pitch=-math.asin(up / length),
        baseline=length,
        fixed=code == _MOVING_BASE_FIXED,
        valid=values.integer("Error_01") == 0,
        code=code,
        rank=1,
    )
    return (attitude,)


def rf_status(values: Values) -> tuple[Content, ...]:
    """Return whether signals are misleading, or not authentic."""
    return (Spoofing(suspected=bool(values.integer("Misleading") or values.integer("Inauthentic"))),)


def _root(variance: float) -> float:
    """Return a standard deviation, NaN of a variance below zero."""
    return math.sqrt(variance) if variance >= 0.0 else math.nan


SBF: dict[int, tuple[str, int, Callable[[Values], tuple[Content, ...]]]] = {
    4007: ("PVTGeodetic", 84, pvt_geodetic),
    5906: ("PosCovGeodetic", 56, pos_cov_geodetic),
    5938: ("AttEuler", 44, att_euler),
    4028: ("BaseVectorGeod", 16, base_vector_geod),
    4092: ("RFStatus", 20, rf_status),
}
"""by block number: name, least length of the block, reader"""
