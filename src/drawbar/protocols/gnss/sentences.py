"""NMEA 0183 sentences that libraries decode: GGA, VTG, RMC, GST, ZDA, HDT, THS, ROT, HRP, HPR and AVR.

Traps: HRP is heading, roll, pitch and HPR heading, pitch, roll; with two antennas one of the two is empty (HRP) or
0.0000 (HPR). HDT, THS, ROT and VTG carry no time. Speed is taken in knots, as every sentence has it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from drawbar.protocols.gnss.messages import (
    Accuracy,
    Attitude,
    Content,
    Date,
    Position,
    Turn,
    Velocity,
)
from drawbar.protocols.gnss.values import KMH, KNOT, LARGEST_SPEED, Values, place
from drawbar.signals import FixQuality

QUALITIES = {
    1: FixQuality.SINGLE,
    2: FixQuality.DIFFERENTIAL,
    4: FixQuality.FIXED,
    5: FixQuality.FLOAT,
}
"""of GGA, PANDA and PAOGI; any other number (PPS, dead reckoning, manual, simulator, PPP) is no fix to drive by"""
_MODES = {"R": FixQuality.FIXED, "F": FixQuality.FLOAT, "D": FixQuality.DIFFERENTIAL, "A": FixQuality.SINGLE}
_HPR_FIXED, _AVR_FIXED = 4, 3
_HRP_FIXED = (2, 4)
_DEGREE_PER_MINUTE = math.radians(1.0) / 60.0


def gga(values: Values) -> tuple[Content, ...]:
    """Return the position with its quality."""
    latitude, longitude = place(values.coordinate("2", "3", "NS"), values.coordinate("4", "5", "EW"))
    altitude, separation = values.number("alt", low=-1e4, high=1e5), values.number("sep", low=-500.0, high=500.0)
    code = values.integer("quality")
    return (
        Position(
            latitude=latitude,
            longitude=longitude,
            height=altitude + separation,
            altitude=altitude,
            separation=separation,
            quality=QUALITIES.get(code or 0, FixQuality.NONE),
            code=code,
            satellites=values.integer("numSV"),
            hdop=values.number("HDOP", low=0.0),
            correction_age=values.correction_age("diffAge"),
            station=values.integer("diffStation"),
            resolution=minutes_resolution(values.text("2"), values.text("4")),
            rank=2,
        ),
    )


def minutes_resolution(latitude: str, longitude: str) -> float:
    """Return what the last digit of ddmm.mmmm is worth in degrees, of the coarser of two."""
    return 10.0 ** -min(len(text.partition(".")[2]) for text in (latitude, longitude)) / 60.0


def vtg(values: Values) -> tuple[Content, ...]:
    """Return course and speed over ground; the course is empty at standstill."""
    speed = values.number("sogn", KNOT, low=0.0, high=LARGEST_SPEED / KNOT)
    if math.isnan(speed):
        speed = values.number("sogk", KMH, low=0.0, high=LARGEST_SPEED / KMH)
    return (Velocity(speed=speed, course=values.yaw("cogt")),)


def rmc(values: Values) -> tuple[Content, ...]:
    """Return date, speed, and a position for receivers that send no better one."""
    latitude, longitude = place(values.coordinate("3", "4", "NS"), values.coordinate("5", "6", "EW"))
    mode = values.text("posMode")
    quality = _MODES.get(mode, FixQuality.NONE) if mode else FixQuality.UNKNOWN
    position = Position(
        latitude=latitude,
        longitude=longitude,
        quality=quality if values.text("status") == "A" else FixQuality.NONE,
        resolution=minutes_resolution(values.text("3"), values.text("5")),
    )
    speed = values.number("spd", KNOT, low=0.0, high=LARGEST_SPEED / KNOT)
    return (position, Velocity(speed=speed, course=values.yaw("cog")), *_date(values, *_day(values.text("9"))))


def gst(values: Values) -> tuple[Content, ...]:
    """Return standard deviations; of the ellipse where those of latitude and longitude are missing."""
    north, east, up = (values.deviation(name) for name in ("stdLat", "stdLong", "stdAlt"))
    major, minor = values.deviation("stdMajor"), values.deviation("stdMinor")
    orientation = values.yaw("orient")
    if math.isnan(north + east):
        sine, cosine = math.sin(orientation), math.cos(orientation)
        north, east = math.hypot(major * sine, minor * cosine), math.hypot(major * cosine, minor * sine)
    impossible = any(deviation <= 0.0 for deviation in (north, east, major, minor))
    accuracy = Accuracy(
        east=east, north=north, up=up, major=major, minor=minor, orientation=orientation, impossible=impossible, rank=1
    )
    return (accuracy,)


def zda(values: Values) -> tuple[Content, ...]:
    """Return the date."""
    return _date(values, values.integer("day"), values.integer("month"), values.integer("year"))


def hdt(values: Values) -> tuple[Content, ...]:
    """Return the heading without quality."""
    return (Attitude(yaw=values.yaw("headingT")),)


def ths(values: Values) -> tuple[Content, ...]:
    """Return the heading with its mode, of which A alone is measured."""
    return (Attitude(yaw=values.yaw("headt"), valid=values.text("mi") == "A"),)


def rot(values: Values) -> tuple[Content, ...]:
    """Return the rate of turn, given in degrees per minute to the right; A: it is measured."""
    return (Turn(yaw_rate=values.number("rot", -_DEGREE_PER_MINUTE)),) if values.text("valid") == "A" else ()


def hrp(values: Values) -> tuple[Content, ...]:
    """Return Septentrio's heading, roll and pitch; mode 0 none, 1 and 3 float, 2 and 4 fixed."""
    mode = values.integer("attmode")
    attitude = Attitude(
        yaw=values.yaw("hdg"),
        roll=values.angle("roll"),
        pitch=-values.angle("pitch"),
        fixed=mode in _HRP_FIXED,
        valid=bool(mode),
        code=mode,
        satellites=values.integer("sip"),
        rank=2,
    )
    return (attitude, *_date(values, *_day(values.text("3"))))


def hpr(values: Values) -> tuple[Content, ...]:
    """Return Unicore's heading, pitch, roll; the one that two antennas cannot measure is 0.0000."""
    code = values.integer("quality")
    roll, pitch = values.angle("roll"), -values.angle("pitch")
    attitude = Attitude(
        yaw=values.yaw("heading"),
        roll=roll if roll != 0.0 else math.nan,
        pitch=pitch if pitch != 0.0 else math.nan,
        fixed=code == _HPR_FIXED,
        valid=bool(code),
        code=code,
        satellites=values.integer("svid"),
        correction_age=values.correction_age("diffAge"),
        rank=2,
    )
    return (attitude,)


def avr(values: Values) -> tuple[Content, ...]:
    """Return Trimble's yaw (clockwise from north), tilt (front up), roll, distance of the antennas."""
    code = values.integer("gpsQual")
    attitude = Attitude(
        yaw=values.yaw("yaw"),
        roll=values.angle("roll"),
        pitch=-values.angle("tilt"),
        baseline=values.number("range", low=0.0),
        fixed=code == _AVR_FIXED,
        valid=bool(code),
        code=code,
        satellites=values.integer("sip"),
        rank=2,
    )
    return (attitude,)


def _day(digits: str) -> tuple[int, int, int] | tuple[None, None, None]:
    """Return ddmmyy as day, month, year."""
    return (int(digits[:2]), int(digits[2:4]), 2000 + int(digits[4:])) if len(digits) == 6 else (None, None, None)


def _date(values: Values, day: int | None, month: int | None, year: int | None) -> tuple[Date, ...]:
    date = values.day(day, month, year)
    return () if date is None else (Date(day=date),)


@dataclass(frozen=True, slots=True, kw_only=True)
class Sentence:
    """How one kind of sentence is read. Fields are counted from 1 behind the address."""

    decode: Callable[[Values], tuple[Content, ...]]
    clock: str = ""
    """number of the field that holds the time; empty: it has none"""
    fields: int
    """least number of fields; a shorter one was cut before its checksum was made"""


SENTENCES = {
    "GGA": Sentence(decode=gga, clock="1", fields=14),
    "VTG": Sentence(decode=vtg, fields=8),
    "RMC": Sentence(decode=rmc, clock="1", fields=11),
    "GST": Sentence(decode=gst, clock="1", fields=8),
    "ZDA": Sentence(decode=zda, clock="1", fields=4),
    "HDT": Sentence(decode=hdt, fields=1),
    "THS": Sentence(decode=ths, fields=2),
    "ROT": Sentence(decode=rot, fields=2),
    "HRP": Sentence(decode=hrp, clock="2", fields=11),
    "HPR": Sentence(decode=hpr, clock="1", fields=5),
    "AVR": Sentence(decode=avr, clock="2", fields=10),
}
