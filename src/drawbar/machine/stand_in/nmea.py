"""NMEA of a receiver's stand-in: GGA VTG GST RMC ZDA HDT THS ROT HRP HPR AVR KSXT, and the boards' PANDA and PAOGI."""

import math

from drawbar.machine.stand_in.receiver import Report, heading
from drawbar.protocols.gnss.checksums import xor
from drawbar.signals import FixQuality

_SEPARATION = 45.7
"""of the geoid, m: any will do"""
_KNOT = 1852.0 / 3600.0
_SLOWEST_COURSE = 0.1
"""below this speed the course is left empty, as receivers do, m/s"""
_QUALITIES = {
    FixQuality.NONE: 0,
    FixQuality.SINGLE: 1,
    FixQuality.DIFFERENTIAL: 2,
    FixQuality.FIXED: 4,
    FixQuality.FLOAT: 5,
}
_MODES = {
    FixQuality.NONE: "N",
    FixQuality.SINGLE: "A",
    FixQuality.DIFFERENTIAL: "D",
    FixQuality.FIXED: "R",
    FixQuality.FLOAT: "F",
}
_KSXT_QUALITIES = {
    FixQuality.NONE: 0,
    FixQuality.SINGLE: 1,
    FixQuality.DIFFERENTIAL: 1,
    FixQuality.FIXED: 3,
    FixQuality.FLOAT: 2,
}
_NO_SENSOR = 65535


def sentence(body: str) -> bytes:
    """Return a body with its frame: $body*hh CR LF."""
    return f"${body}*{xor(body.encode('ascii')):02X}\r\n".encode("ascii")


def gga(report: Report) -> bytes:
    """Return position, 7 decimals of minutes."""
    if not report.has_fix:
        return sentence(f"GNGGA,{_clock(report)},,,,,0,,,,,,,,")
    altitude = report.height - _SEPARATION
    tail = f"{altitude:.4f},M,{_SEPARATION:.3f},M,{report.correction_age:.1f},{report.station:04d}"
    return sentence(
        f"GNGGA,{_clock(report)},{_place(report)},{_QUALITIES[report.quality]},{report.satellites},0.70,{tail}"
    )


def vtg(report: Report) -> bytes:
    """Return course and speed."""
    speed = f"{report.speed / _KNOT:.4f},N,{report.speed * 3.6:.4f},K"
    return sentence(f"GNVTG,{_course(report)},T,,M,{speed},{_MODES[report.quality]}")


def gst(report: Report) -> bytes:
    """Return standard deviations."""
    if not report.has_fix:
        return sentence(f"GNGST,{_clock(report)},,,,,,,")
    north, east = report.sigma_north, report.sigma_east
    ellipse = f"{max(north, east):.4f},{min(north, east):.4f},{0.0 if north >= east else 90.0}"
    return sentence(f"GNGST,{_clock(report)},1.0,{ellipse},{north:.4f},{east:.4f},{2.0 * north:.4f}")


def rmc(report: Report) -> bytes:
    """Return position, speed and date."""
    day = f"{report.time:%d%m%y}"
    if not report.has_fix:
        return sentence(f"GNRMC,{_clock(report)},V,,,,,,,{day},,,N,V")
    moving = f"{report.speed / _KNOT:.4f},{_course(report)}"
    return sentence(f"GNRMC,{_clock(report)},A,{_place(report)},{moving},{day},,,{_MODES[report.quality]},V")


def zda(report: Report) -> bytes:
    """Return date."""
    return sentence(f"GNZDA,{_clock(report)},{report.time:%d,%m,%Y},00,00")


def hdt(report: Report) -> bytes:
    """Return heading without time."""
    return sentence(f"GNHDT,{_heading(report)},T")


def ths(report: Report) -> bytes:
    """Return heading with its mode."""
    return sentence(f"GNTHS,{_heading(report)},{'A' if _heading(report) else 'V'}")


def rot(report: Report) -> bytes:
    """Return the rate of turn, degrees per minute to the right; V: it is not measured."""
    turns = math.isfinite(report.yaw_rate)
    return sentence(f"GNROT,{-60.0 * math.degrees(report.yaw_rate):.2f},A" if turns else "GNROT,,V")


def hrp(report: Report) -> bytes:
    """Return Septentrio's heading, roll, pitch; an axis that is missing is empty."""
    mode = 0 if math.isnan(report.yaw) else (2 if math.isnan(report.roll) else 4) - (not report.heading_is_fixed)
    angles = f"{_heading(report)},{_degrees(report.roll)},{_degrees(-report.pitch)}"
    sigma = f"{math.degrees(report.attitude_sigma):.4f}" if mode else ""
    deviations = f"{sigma},{sigma if math.isfinite(report.roll) else ''},{sigma}"
    tail = f"{report.satellites},{mode},1.5,E"
    return sentence(f"PSSN,HRP,{_clock(report)},{report.time:%d%m%y},{angles},{deviations},{tail}")


def hpr(report: Report) -> bytes:
    """Return Unicore's heading, pitch, roll; an axis that is missing is 0.0000."""
    quality = 0 if math.isnan(report.yaw) else 4 if report.heading_is_fixed else 5
    angles = f"{_heading(report)},{_degrees(-report.pitch) or '0.0000'},{_degrees(report.roll) or '0.0000'}"
    tail = f"{report.satellites},{report.correction_age:.1f},{report.station:04d}"
    return sentence(f"GNHPR,{_clock(report)},{angles},{quality},{tail}")


def avr(report: Report) -> bytes:
    """Return Trimble's yaw, tilt, roll and distance of the antennas."""
    quality = 0 if math.isnan(report.yaw) else 3 if report.heading_is_fixed else 2
    angles = f"{_heading(report)},Yaw,{_degrees(-report.pitch)},Tilt,{_degrees(report.roll)},Roll"
    return sentence(f"PTNL,AVR,{_clock(report)},{angles},{report.baseline:.4f},{quality},1.5,{report.satellites}")


def ksxt(report: Report) -> bytes:
    """Return Unicore's all in one, decimal degrees."""
    stamp = f"{report.time:%Y%m%d}{_clock(report)}"
    place = f"{report.longitude:.10f},{report.latitude:.10f},{report.height:.4f}" if report.has_fix else ",,"
    angles = f"{_heading(report)},{_degrees(-report.pitch)},{_course(report)},{report.speed * 3.6:.4f},"
    attitude = 0 if math.isnan(report.yaw) else 3 if report.heading_is_fixed else 2
    tail = f"{_KSXT_QUALITIES[report.quality]},{attitude},{report.satellites},{report.satellites}"
    return sentence(f"KSXT,{stamp},{place},{angles},{tail},,,,,,,,")


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
    return sentence(f"PAOGI,{_board(report)},{heading(report.yaw):.2f},{_degrees(report.roll, 2)},,")


def _board(report: Report) -> str:
    """Return what PANDA and PAOGI share."""
    place = _place(report) if report.has_fix else ",,,"
    altitude = f"{report.height - _SEPARATION:.4f}" if report.has_fix else ""
    quality = f"{_QUALITIES[report.quality]},{report.satellites},0.70"
    return f"{_clock(report)},{place},{quality},{altitude},{report.correction_age:.1f},{report.speed / _KNOT:.4f}"


def _clock(report: Report) -> str:
    return f"{report.time:%H%M%S}.{report.time.microsecond // 1000:03d}"


def _place(report: Report) -> str:
    """Return ddmm.mmmmmmm,N,dddmm.mmmmmmm,E, without minutes that round to 60."""
    latitude, longitude = _minutes(report.latitude, 2), _minutes(report.longitude, 3)
    return f"{latitude},{'N' if report.latitude >= 0.0 else 'S'},{longitude},{'E' if report.longitude >= 0.0 else 'W'}"


def _minutes(degrees: float, width: int) -> str:
    whole, rest = divmod(round(abs(degrees) * 60.0 * 1e7), 60 * 10**7)
    return f"{whole:0{width}d}{rest // 10**7:02d}.{rest % 10**7:07d}"


def _course(report: Report) -> str:
    if math.isnan(report.course) or report.speed < _SLOWEST_COURSE:
        return ""
    return f"{heading(report.course):.4f}"


def _heading(report: Report) -> str:
    return "" if math.isnan(report.yaw) else f"{heading(report.yaw):.4f}"


def _degrees(angle: float, decimals: int = 4) -> str:
    return "" if math.isnan(angle) else f"{math.degrees(angle):.{decimals}f}"


def sentences(report: Report) -> list[bytes]:
    """Return one epoch as most receivers are set up: GGA, VTG, GST and, with two antennas, HRP and ROT."""
    attitude = [] if math.isnan(report.yaw) else [hrp(report), rot(report)]
    return [gga(report), vtg(report), gst(report), *attitude]
