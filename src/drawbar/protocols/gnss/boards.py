"""Sentences that no library decodes: $PANDA and $PAOGI of AgOpenGPS's boards, $KSXT of Unicore."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from drawbar.geometry import wrap
from drawbar.protocols.gnss.messages import Attitude, Content, Date, InertialAttitude, Position, Velocity
from drawbar.protocols.gnss.sentences import QUALITIES, minutes_resolution
from drawbar.protocols.gnss.values import KMH, KNOT, LARGEST_SPEED, Values, place
from drawbar.signals import FixQuality

_NO_SENSOR = 65535
_TENTHS = math.radians(0.1)
_KSXT_QUALITIES = {1: FixQuality.SINGLE, 2: FixQuality.FLOAT, 3: FixQuality.FIXED}
_KSXT_FIXED = 3


def panda(values: Values) -> tuple[Content, ...]:
    """Return what one antenna and an inertial sensor measure, in integers of 0.1°; without sensor the rest is stale.

    The last field is called yaw rate. Most firmware sends 0 there, other firmware numbers of a scale of its own:
    it is not taken.
    """
    contents = _board(values)
    if values.number("12") == _NO_SENSOR:
        return contents
    inertial = InertialAttitude(
        yaw=wrap(math.pi / 2.0 - values.number("12", _TENTHS, low=-1800.0, high=3600.0)),
        roll=values.angle("13", 0.1),
        pitch=-values.angle("14", 0.1),
    )
    return (*contents, inertial)


def paogi(values: Values) -> tuple[Content, ...]:
    """Return what two antennas measure, in degrees; the board sends it only while the heading is fixed."""
    attitude = Attitude(yaw=values.yaw("12"), roll=values.angle("13"), pitch=-values.angle("14"), fixed=True, rank=2)
    return (*_board(values), attitude)


def _board(values: Values) -> tuple[Content, ...]:
    """Return what both sentences share: position and speed. The geoid, over which the altitude stands, is not sent."""
    latitude, longitude = place(values.coordinate("2", "3", "NS"), values.coordinate("4", "5", "EW"))
    code = values.integer("6")
    position = Position(
        latitude=latitude,
        longitude=longitude,
        altitude=values.number("9", low=-1e4, high=1e5),
        quality=QUALITIES.get(code or 0, FixQuality.NONE),
        code=code,
        satellites=values.integer("7"),
        hdop=values.number("8", low=0.0),
        correction_age=values.correction_age("10"),
        resolution=minutes_resolution(values.text("2"), values.text("4")),
        rank=2,
    )
    return position, Velocity(speed=values.number("11", KNOT, low=0.0, high=LARGEST_SPEED / KNOT))


def ksxt(values: Values) -> tuple[Content, ...]:
    """Return position, heading and speed: longitude before latitude, decimal degrees, separate qualities."""
    latitude, longitude = place(values.number("3", low=-90.0, high=90.0), values.number("2", low=-180.0, high=180.0))
    code, heading = values.integer("10"), values.integer("11")
    digits = min(len(values.text(name).partition(".")[2]) for name in "23")
    position = Position(
        latitude=latitude,
        longitude=longitude,
        height=values.number("4", low=-1e4, high=1e5),
        quality=_KSXT_QUALITIES.get(code or 0, FixQuality.NONE),
        code=code,
        satellites=values.integer("13"),
        resolution=10.0**-digits,
        rank=2,
    )
    pitch = -values.angle("6")
    attitude = Attitude(
        yaw=values.yaw("5"), pitch=pitch, fixed=heading == _KSXT_FIXED, valid=bool(heading), code=heading, rank=2
    )
    velocity = Velocity(speed=values.number("8", KMH, low=0.0, high=LARGEST_SPEED / KMH), course=values.yaw("7"))
    stamp = values.text("1")
    day = (int(stamp[6:8]), int(stamp[4:6]), int(stamp[:4])) if len(stamp) >= 8 else (None, None, None)
    date = values.day(*day)
    return (position, velocity, attitude, *(() if date is None else (Date(day=date),)))


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardSentence:
    """How one of these sentences is read."""

    decode: Callable[[Values], tuple[Content, ...]]
    clock: int = 0
    """where the time of day begins in the first field"""
    fields: range
    """how many there may be; senders that insert units mean something else by each field"""


BOARDS = {
    "PANDA": BoardSentence(decode=panda, fields=range(15, 16)),
    "PAOGI": BoardSentence(decode=paogi, fields=range(15, 16)),
    "KSXT": BoardSentence(decode=ksxt, clock=len("yyyymmdd"), fields=range(13, 40)),
}
