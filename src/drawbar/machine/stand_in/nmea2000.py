"""NMEA 2000 of a receiver's stand-in, as packed CAN frames: position (129029), course and speed (129026).

With two antennas also their heading (127250), with an inertial sensor rate of turn (127251) and attitude (127257).
"""

import math
import struct
from collections.abc import Iterator

from drawbar.machine.stand_in.receiver import Encoder, Report, turned
from drawbar.protocols.isobus.identifier import Message, encode
from drawbar.protocols.nmea2000.messages import (
    ATTITUDE,
    COURSE_SPEED,
    GNSS_POSITION,
    HEADING,
    RATE_OF_TURN,
    FixMethod,
)
from drawbar.signals import FixQuality
from drawbar.transports.can_listener import packed

_METHODS = {
    FixQuality.NONE: FixMethod.NONE,
    FixQuality.SINGLE: FixMethod.SINGLE,
    FixQuality.DIFFERENTIAL: FixMethod.DIFFERENTIAL,
    FixQuality.FLOAT: FixMethod.RTK_FLOAT,
    FixQuality.FIXED: FixMethod.RTK_FIXED,
}
_POSITION = struct.Struct("<BHIqqqBBBhhiBHH")
_MOTION = struct.Struct("<BBHHH")
_DIRECTION = struct.Struct("<BHHHB")
_TURN, _ATTITUDE = struct.Struct("<Bi3x"), struct.Struct("<BHhhx")
_SIDS = 253
_DAY = 86400.0
_SAFE = 1


def nmea2000(source: int, line: float = 0.0) -> Encoder:
    """Return what makes frames of reports, sent from an address.

    line: angle of the line between two antennas to the body's forward direction, rad.
    """
    counter = iter(_count())

    def encoder(report: Report) -> list[bytes]:
        count = next(counter)
        joined = [Message(pgn=COURSE_SPEED, source=source, priority=2, data=_motion(report, count % _SIDS))]
        if math.isfinite(report.yaw) and report.heading_is_fixed:
            direction = _direction(turned(report, line), count % _SIDS)
            joined.append(Message(pgn=HEADING, source=source, priority=2, data=direction))
        if math.isfinite(report.roll + report.pitch + report.yaw_rate):
            turn, attitude = _turn(report, count % _SIDS), _attitude(report, count % _SIDS)
            joined.append(Message(pgn=RATE_OF_TURN, source=source, priority=2, data=turn))
            joined.append(Message(pgn=ATTITUDE, source=source, priority=3, data=attitude))
        whole = _position(report, count % _SIDS)
        pieces = [bytes((len(whole),)) + whole[:6], *(whole[at : at + 7] for at in range(6, len(whole), 7))]
        frames = [
            Message(
                pgn=GNSS_POSITION, source=source, data=(bytes(((count % 8) << 5 | index,)) + piece).ljust(8, b"\xff")
            )
            for index, piece in enumerate(pieces)
        ]
        return [packed(encode(message)) for message in (*frames, *joined)]

    return encoder


def _count() -> Iterator[int]:
    count = 0
    while True:
        yield count
        count += 1


def _position(report: Report, sid: int) -> bytes:
    days, seconds = divmod(report.time.timestamp(), _DAY)
    latitude, longitude = (round(each * 1e16) for each in (report.latitude, report.longitude))
    return _POSITION.pack(
        sid,
        int(days),
        round(seconds * 1e4),
        latitude,
        longitude,
        round(report.height * 1e6),
        _METHODS[report.quality] << 4,
        0xFC | _SAFE,
        report.satellites,
        70,
        100,
        0,
        1,
        report.station << 4,
        round(report.correction_age * 100.0),
    )


def _motion(report: Report, sid: int) -> bytes:
    course = 0xFFFF if math.isnan(report.course) else round((math.pi / 2 - report.course) % (2.0 * math.pi) * 1e4)
    return _MOTION.pack(sid, 0xFC, course, round(report.speed * 100.0), 0xFFFF)


def _direction(report: Report, sid: int) -> bytes:
    heading = round((math.pi / 2 - report.yaw) % (2.0 * math.pi) * 1e4)
    return _DIRECTION.pack(sid, heading, 0x7FFF, 0x7FFF, 0xFC)  # no deviation, no variation: to true north


def _turn(report: Report, sid: int) -> bytes:
    return _TURN.pack(sid, round(-report.yaw_rate * 32e6))  # to the right


def _attitude(report: Report, sid: int) -> bytes:
    return _ATTITUDE.pack(sid, 0x7FFF, round(-report.pitch * 1e4), round(report.roll * 1e4))  # nose up
