"""NMEA of receivers: what a drive's stand-in sends, and the other sentences that receivers are set up to send."""

import math

from drawbar.machine.stand_in.nmea import (
    KNOT,
    MODES,
    clock_of,
    course_of,
    degrees_of,
    gga,
    gst,
    heading_of,
    hrp,
    place_of,
    sentence,
    vtg,
)
from drawbar.machine.stand_in.nmea import panda as panda
from drawbar.machine.stand_in.nmea import paogi as paogi
from drawbar.machine.stand_in.receiver import Report
from drawbar.signals import FixQuality

_KSXT_QUALITIES = {
    FixQuality.NONE: 0,
    FixQuality.SINGLE: 1,
    FixQuality.DIFFERENTIAL: 1,
    FixQuality.FIXED: 3,
    FixQuality.FLOAT: 2,
}


def rmc(report: Report) -> bytes:
    """Return position, speed and date."""
    day = f"{report.time:%d%m%y}"
    if not report.has_fix:
        return sentence(f"GNRMC,{clock_of(report)},V,,,,,,,{day},,,N,V")
    moving = f"{report.speed / KNOT:.4f},{course_of(report)}"
    return sentence(f"GNRMC,{clock_of(report)},A,{place_of(report)},{moving},{day},,,{MODES[report.quality]},V")


def zda(report: Report) -> bytes:
    """Return date."""
    return sentence(f"GNZDA,{clock_of(report)},{report.time:%d,%m,%Y},00,00")


def hdt(report: Report) -> bytes:
    """Return heading without time."""
    return sentence(f"GNHDT,{heading_of(report)},T")


def ths(report: Report) -> bytes:
    """Return heading with its mode."""
    return sentence(f"GNTHS,{heading_of(report)},{'A' if heading_of(report) else 'V'}")


def rot(report: Report) -> bytes:
    """Return the rate of turn, degrees per minute to the right; V: it is not measured."""
    turns = math.isfinite(report.yaw_rate)
    return sentence(f"GNROT,{-60.0 * math.degrees(report.yaw_rate):.2f},A" if turns else "GNROT,,V")


def hpr(report: Report) -> bytes:
    """Return Unicore's heading, pitch, roll; an axis that is missing is 0.0000."""
    quality = 0 if math.isnan(report.yaw) else 4 if report.heading_is_fixed else 5
    angles = f"{heading_of(report)},{degrees_of(-report.pitch) or '0.0000'},{degrees_of(report.roll) or '0.0000'}"
    tail = f"{report.satellites},{report.correction_age:.1f},{report.station:04d}"
    return sentence(f"GNHPR,{clock_of(report)},{angles},{quality},{tail}")


def avr(report: Report) -> bytes:
    """Return Trimble's yaw, tilt, roll and distance of the antennas."""
    quality = 0 if math.isnan(report.yaw) else 3 if report.heading_is_fixed else 2
    angles = f"{heading_of(report)},Yaw,{degrees_of(-report.pitch)},Tilt,{degrees_of(report.roll)},Roll"
    return sentence(f"PTNL,AVR,{clock_of(report)},{angles},{report.baseline:.4f},{quality},1.5,{report.satellites}")


def ksxt(report: Report) -> bytes:
    """Return Unicore's all in one, decimal degrees."""
    stamp = f"{report.time:%Y%m%d}{clock_of(report)}"
    place = f"{report.longitude:.10f},{report.latitude:.10f},{report.height:.4f}" if report.has_fix else ",,"
    angles = f"{heading_of(report)},{degrees_of(-report.pitch)},{course_of(report)},{report.speed * 3.6:.4f},"
    attitude = 0 if math.isnan(report.yaw) else 3 if report.heading_is_fixed else 2
    tail = f"{_KSXT_QUALITIES[report.quality]},{attitude},{report.satellites},{report.satellites}"
    return sentence(f"KSXT,{stamp},{place},{angles},{tail},,,,,,,,")


def sentences(report: Report) -> list[bytes]:
    """Return one epoch as most receivers are set up: GGA, VTG, GST and, with two antennas, HRP and ROT."""
    attitude = [] if math.isnan(report.yaw) else [hrp(report), rot(report)]
    return [gga(report), vtg(report), gst(report), *attitude]
