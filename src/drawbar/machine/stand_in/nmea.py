"""NMEA of a receiver's stand-in: GGA VTG GST HRP, and the boards' PANDA and PAOGI."""

import math

from drawbar.machine.stand_in.receiver import Report, heading
from drawbar.protocols.gnss.checksums import xor
from drawbar.signals import FixQuality

_SEPARATION = 45.7
"""of the geoid, m: any will do"""
KNOT = 1852.0 / 3600.0
"""m/s"""
_SLOWEST_COURSE = 0.1
"""below this speed the course is left empty, as receivers do, m/s"""
_QUALITIES = {
    FixQuality.NONE: 0,
    FixQuality.SINGLE: 1,
    FixQuality.DIFFERENTIAL: 2,
    FixQuality.FIXED: 4,
    FixQuality.FLOAT: 5,
}
MODES = {
    FixQuality.NONE: "N",
    FixQuality.SINGLE: "A",
    FixQuality.DIFFERENTIAL: "D",
    FixQuality.FIXED: "R",
    FixQuality.FLOAT: "F",
}
_NO_SENSOR = 65535


def sentence(body: str) -> bytes:
    """Return a body with its frame: $body*hh CR LF."""
    return f"${body}*{xor(body.encode('ascii')):02X}\r\n".encode("ascii")


def gga(report: Report) -> bytes:
    """Return position, 7 decimals of minutes."""
    if not report.has_fix:
        return sentence(f"GNGGA,{clock_of(report)},,,,,0,,,,,,,,")
    altitude = report.height - _SEPARATION
    tail = f"{altitude:.4f},M,{_SEPARATION:.3f},M,{report.correction_age:.1f},{report.station:04d}"
    return sentence(
        f"GNGGA,{clock_of(report)},{place_of(report)},{_QUALITIES[report.quality]},{report.satellites},0.70,{tail}"
    )


def vtg(report: Report) -> bytes:
    """Return course and speed."""
    speed = f"{report.speed / KNOT:.4f},N,{report.speed * 3.6:.4f},K"
    return sentence(f"GNVTG,{course_of(report)},T,,M,{speed},{MODES[report.quality]}")


def gst(report: Report) -> bytes:
    """Return standard deviations."""
    if not report.has_fix:
        return sentence(f"GNGST,{clock_of(report)},,,,,,,")
    north, east = report.sigma_north, report.sigma_east
    ellipse = f"{max(north, east):.4f},{min(north, east):.4f},{0.0 if north >= east else 90.0}"
    return sentence(f"GNGST,{clock_of(report)},1.0,{ellipse},{north:.4f},{east:.4f},{2.0 * north:.4f}")


def hrp(report: Report) -> bytes:
    """Return Septentrio's heading, roll, pitch; an axis that is missing is empty."""
    mode = 0 if math.isnan(report.yaw) else (2 if math.isnan(report.roll) else 4) - (not report.heading_is_fixed)
    angles = f"{heading_of(report)},{degrees_of(report.roll)},{degrees_of(-report.pitch)}"
    sigma = f"{math.degrees(report.attitude_sigma):.4f}" if mode else ""
    deviations = f"{sigma},{sigma if math.isfinite(report.roll) else ''},{sigma}"
    tail = f"{report.satellites},{mode},1.5,E"
    return sentence(f"PSSN,HRP,{clock_of(report)},{report.time:%d%m%y},{angles},{deviations},{tail}")


def panda(report: Report) -> bytes:
    """Return what a board with an inertial sensor sends: integers of 0.1°, and 0 for the yaw rate."""
    angles = f"{_NO_SENSOR},,,"
    if math.isfinite(report.inertial_yaw + report.roll + report.pitch):
        degrees = heading(report.inertial_yaw), math.degrees(report.roll), -math.degrees(report.pitch)
        angles = f"{','.join(f'{10.0 * each:.0f}' for each in degrees)},0"
    return sentence(f"PANDA,{_board(report)},{angles}")


def paogi(report: Report) -> bytes:
    """Return what a board with two antennas sends: no sentence at all while the heading is not fixed."""
    if math.isnan(report.yaw) or not report.heading_is_fixed:
        return b""
    return sentence(f"PAOGI,{_board(report)},{heading(report.yaw):.2f},{degrees_of(report.roll, 2)},,")


def _board(report: Report) -> str:
    """Return what PANDA and PAOGI share."""
    place = place_of(report) if report.has_fix else ",,,"
    altitude = f"{report.height - _SEPARATION:.4f}" if report.has_fix else ""
    quality = f"{_QUALITIES[report.quality]},{report.satellites},0.70"
    return f"{clock_of(report)},{place},{quality},{altitude},{report.correction_age:.1f},{report.speed / KNOT:.4f}"


def clock_of(report: Report) -> str:
    """Return hhmmss.sss."""
    return f"{report.time:%H%M%S}.{report.time.microsecond // 1000:03d}"


def place_of(report: Report) -> str:
    """Return ddmm.mmmmmmm,N,dddmm.mmmmmmm,E, without minutes that round to 60."""
    latitude, longitude = _minutes(report.latitude, 2), _minutes(report.longitude, 3)
    return f"{latitude},{'N' if report.latitude >= 0.0 else 'S'},{longitude},{'E' if report.longitude >= 0.0 else 'W'}"


def _minutes(degrees: float, width: int) -> str:
    whole, rest = divmod(round(abs(degrees) * 60.0 * 1e7), 60 * 10**7)
    return f"{whole:0{width}d}{rest // 10**7:02d}.{rest % 10**7:07d}"


def course_of(report: Report) -> str:
    """Return the course in degrees clockwise from north; empty where there is none."""
    if math.isnan(report.course) or report.speed < _SLOWEST_COURSE:
        return ""
    return f"{heading(report.course):.4f}"


def heading_of(report: Report) -> str:
    """Return the heading of the line between the antennas, likewise."""
    return "" if math.isnan(report.yaw) else f"{heading(report.yaw):.4f}"


def degrees_of(angle: float, decimals: int = 4) -> str:
    """Return an angle (rad) in degrees; empty where it is missing."""
    return "" if math.isnan(angle) else f"{math.degrees(angle):.{decimals}f}"
