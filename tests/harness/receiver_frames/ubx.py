"""UBX of a receiver: NAV-PVT, NAV-HPPOSLLH and NAV-RELPOSNED of one epoch."""

import math
import struct

from drawbar.machine.stand_in.receiver import Report, heading
from drawbar.protocols.gnss.checksums import fletcher
from drawbar.signals import FixQuality
from receiver_frames.times import gps_time, velocity

_CARRIER = {FixQuality.FLOAT: 1, FixQuality.FIXED: 2}
_AGES = (1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0)
"""upper ends of the classes of the age of corrections, from class 1, s"""
_UBX_FIX = 0x01
_UBX_DIFFERENTIAL = 0x02


def frame(class_: int, number: int, payload: bytes) -> bytes:
    """Return a payload with its frame: B5 62, class, id, length, payload, checksum."""
    body = bytes((class_, number)) + struct.pack("<H", len(payload)) + payload
    return b"\xb5\x62" + body + fletcher(body)


def pvt(report: Report) -> bytes:
    """Return position to 1.1 cm, velocity, quality."""
    _, milliseconds = gps_time(report)
    time, (east, north) = report.time, velocity(report)
    longitude, latitude, height = (
        round(report.longitude * 1e7),
        round(report.latitude * 1e7),
        round(report.height * 1e3),
    )
    accuracy = math.hypot(report.sigma_east, report.sigma_north)
    differential = report.quality >= FixQuality.DIFFERENTIAL
    flags = (_UBX_FIX if report.has_fix else 0) | (_UBX_DIFFERENTIAL if differential else 0)
    age = 1 + sum(report.correction_age > end for end in _AGES) if differential else 0
    payload = struct.pack(
        "<IH5BBIiBBBBiiiiIIiiiiiIIH",
        milliseconds,
        time.year,
        *(time.month, time.day, time.hour, time.minute, time.second),
        0x37,  # date, time and second known
        25,
        time.microsecond * 1000,
        3 if report.has_fix else 0,
        flags | _CARRIER.get(report.quality, 0) << 6,
        0,
        report.satellites,
        *(longitude, latitude, height, height),
        *(round(accuracy * 1e3), round(2e3 * accuracy)),
        *(round(north * 1e3), round(east * 1e3), 0, round(report.speed * 1e3)),
        0 if math.isnan(report.course) else round(heading(report.course) * 1e5),
        *(30, 200000, 130),
    )
    return frame(0x01, 0x07, payload + struct.pack("<H12x", (0 if report.has_fix else 1) | age << 1))


def hpposllh(report: Report) -> bytes:
    """Return position to 0.1 mm."""
    _, milliseconds = gps_time(report)
    places = [_split(value, 100) for value in (report.longitude * 1e9, report.latitude * 1e9)]
    (longitude, longitude_rest), (latitude, latitude_rest) = places
    height, height_rest = _split(report.height * 1e4, 10)
    accuracy = math.hypot(report.sigma_east, report.sigma_north) * 1e4
    payload = struct.pack(
        "<3xBIiiiibbbbII",
        *(0 if report.has_fix else 1, milliseconds, longitude, latitude, height, height),
        *(longitude_rest, latitude_rest, height_rest, height_rest, round(accuracy), round(2.0 * accuracy)),
    )
    return frame(0x01, 0x14, payload)


def relposned(report: Report) -> bytes:
    """Return the vector from the moving base's antenna to the other one, along the reported yaw and pitch."""
    _, milliseconds = gps_time(report)
    given = math.isfinite(report.yaw)
    yaw, pitch = (report.yaw, 0.0 if math.isnan(report.pitch) else report.pitch) if given else (0.0, 0.0)
    level = report.baseline * math.cos(pitch)
    vector = (level * math.sin(yaw), level * math.cos(yaw), report.baseline * math.sin(pitch), report.baseline)
    parts = [_split(value * 1e4, 100) for value in vector]
    carrier = 2 if report.heading_is_fixed else 1
    flags = (0b101 | _UBX_DIFFERENTIAL | carrier << 3 | 1 << 5 | 1 << 8) if given else 1 << 5
    payload = struct.pack(
        "<BxHIiiiii4x4bIIIII4xI",
        *(1, 0, milliseconds),
        *(whole for whole, _ in parts),
        round(heading(yaw) * 1e5),
        *(rest for _, rest in parts),
        *(60, 60, 110, 60),
        round(math.degrees(report.attitude_sigma) * 1e5),
        flags,
    )
    return frame(0x01, 0x3C, payload)


def _split(value: float, divisor: int) -> tuple[int, int]:
    """Return a whole number as multiples of the divisor and what is left of it, at most half of it."""
    whole = round(value)
    high = round(whole / divisor)
    return high, whole - high * divisor


def frames(report: Report) -> list[bytes]:
    """Return one epoch: NAV-PVT, NAV-HPPOSLLH and, with two antennas, NAV-RELPOSNED."""
    return [pvt(report), hpposllh(report), *([] if math.isnan(report.yaw) else [relposned(report)])]
