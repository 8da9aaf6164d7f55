"""SBF of a receiver: PVTGeodetic, PosCovGeodetic and AttEuler of one epoch."""

import math
import struct

from drawbar.machine.stand_in.receiver import Report, heading
from drawbar.protocols.gnss.checksums import crc_ccitt
from drawbar.signals import FixQuality
from receiver_frames.times import gps_time, velocity

_UNUSED = -2e10
_TYPES = {FixQuality.SINGLE: 1, FixQuality.DIFFERENTIAL: 2, FixQuality.FIXED: 4, FixQuality.FLOAT: 5}
_SLOWEST_COURSE = 0.1
"""m/s"""


def block(number: int, revision: int, report: Report, body: bytes) -> bytes:
    """Return a body with its header: $@, CRC, id, length, time of week, week; padded to a multiple of 4."""
    week, milliseconds = gps_time(report)
    body += bytes(-(14 + len(body)) % 4)
    tail = struct.pack("<HHIH", number | revision << 13, 14 + len(body), milliseconds, week) + body
    return b"$@" + struct.pack("<H", crc_ccitt(tail)) + tail


def pvt_geodetic(report: Report) -> bytes:
    """Return position and velocity; do-not-use values without a fix."""
    if not report.has_fix:
        floats = struct.pack("<3d5f", *[_UNUSED] * 8)
        tail = struct.pack(
            "<dfBBBBHHIBBHHHHB", _UNUSED, _UNUSED, 255, 255, 255, 0, 65535, 65535, *[0] * 4, *[65535] * 3, 0
        )
        return block(4007, 2, report, b"\0\1" + floats + tail)
    east, north = velocity(report)
    moving = math.isfinite(report.course) and report.speed >= _SLOWEST_COURSE
    course = heading(report.course) if moving else _UNUSED
    place = (math.radians(report.latitude), math.radians(report.longitude), report.height)
    age, accuracy = round(report.correction_age * 100.0), 2.0 * math.hypot(report.sigma_east, report.sigma_north)
    radius = min(round(accuracy * 100.0), 65534)
    body = struct.pack("<BB3d5f", _TYPES[report.quality], 0, *place, 45.7, north, east, 0.0, course)
    body += struct.pack("<dfBBBBHHI", 0.0, 0.0, 0, 0, report.satellites, 0, report.station, min(age, 65534), 0)
    return block(4007, 2, report, body + struct.pack("<BBHHHHB", 0, 1, 0, 0, radius, radius, 0))


def pos_cov_geodetic(report: Report) -> bytes:
    """Return covariance of the position."""
    if not report.has_fix:
        return block(5906, 0, report, struct.pack("<BB10f", 0, 1, *[_UNUSED] * 10))
    north, east = report.sigma_north**2, report.sigma_east**2
    variances = (north, east, 4.0 * north, north, *[0.0] * 6)
    return block(5906, 0, report, struct.pack("<BB10f", _TYPES[report.quality], 0, *variances))


def att_euler(report: Report) -> bytes:
    """Return heading, pitch (front up), roll and the heading's rate; what is missing is not to be used."""
    mode = 0 if math.isnan(report.yaw) else (2 if math.isnan(report.roll) else 4) - (not report.heading_is_fixed)
    angles = [heading(report.yaw) if mode else _UNUSED]
    angles += [_UNUSED if math.isnan(each) or not mode else math.degrees(each) for each in (-report.pitch, report.roll)]
    rate = -math.degrees(report.yaw_rate) if mode and math.isfinite(report.yaw_rate) else _UNUSED
    body = struct.pack("<BBHH6f", report.satellites, 0 if mode else 128, mode, 0, *angles, _UNUSED, _UNUSED, rate)
    return block(5938, 0, report, body)


def blocks(report: Report) -> list[bytes]:
    """Return one epoch: PVTGeodetic, PosCovGeodetic and, with two antennas, AttEuler."""
    attitude = [] if math.isnan(report.yaw) else [att_euler(report)]
    return [pvt_geodetic(report), pos_cov_geodetic(report), *attitude]
