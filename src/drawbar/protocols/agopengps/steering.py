"""Steering messages: set points to a steer board (254), and what it reports (253)."""

import math
import struct
from dataclasses import dataclass

from drawbar.protocols.agopengps.frame import COMPUTER, STEER_BOARD, Frame, Pgn, byte, pack, scaled

_HUNDREDTHS = math.degrees(1.0) * 100.0
"""counts of an angle on the wire, right positive, per radian"""
_SPEED = 36.0
"""counts of a speed on the wire, km/h x 10, per m/s"""
_CROSS_TRACK = 50.0
"""counts of a distance from the line on the wire per metre"""
_NO_LINE = 255


@dataclass(frozen=True, slots=True, kw_only=True)
class SteerCommand:
    """What a computer asks of a steer board at 10 to 20 Hz (254)."""

    steer: bool
    """whether it is to steer; boards begin with the change from False to True only"""
    angle: float
    """set point, rad, left positive"""
    speed: float
    """of the vehicle, m/s, in either direction; the wire has no sign"""
    cross_track: float | None = None
    """distance from the line, m, left positive, saturated at ±2.54 m for the board's light bar; None: no line"""
    sections: int = 0
    """bits of the sections 1 to 16 that are on"""

    def encode(self) -> bytes:
        """Return the datagram.

        Raises HardwareError when a number is not finite or does not fit the wire.
        """
        data = struct.pack(
            "<HBhBH",
            scaled("speed, m/s,", abs(self.speed), _SPEED, 0, 0xFFFF),
            int(self.steer),
            scaled("steering angle, rad,", -self.angle, _HUNDREDTHS, -0x7FFF, 0x7FFF),
            _line_distance(self.cross_track),
            byte("sections", self.sections, 0, 0xFFFF),
        )
        return pack(COMPUTER, Pgn.STEER, data)


def _line_distance(cross_track: float | None) -> int:
    if cross_track is None:
        return _NO_LINE
    saturated = cross_track if not math.isfinite(cross_track) else min(max(-cross_track, -2.54), 2.54)
    return scaled("distance from the line, m,", saturated, _CROSS_TRACK, -127, 127) + 127


def decode_steer(frame: Frame) -> tuple[SteerCommand, int] | None:
    """Return a set point that another program sends, and its status byte as it is; None: not such a message."""
    if (frame.source, frame.pgn, len(frame.data)) != (COMPUTER, Pgn.STEER, 8):
        return None
    speed, status, angle, distance, sections = struct.unpack("<HBhBH", frame.data)
    command = SteerCommand(
        steer=bool(status & 1),
        angle=-angle / _HUNDREDTHS,
        speed=speed / _SPEED,
        cross_track=None if distance == _NO_LINE else (127 - distance) / _CROSS_TRACK,
        sections=sections,
    )
    return command, status


@dataclass(frozen=True, slots=True, kw_only=True)
class SteerReply:
    """What a steer board measures (253). Its heading and roll are left out: AiO_26 sends zeros there."""

    angle: float
    """rad, left positive"""
    steer_off: bool
    """the board will not steer: never begun, switched off, or taken over by the operator"""
    work_off: bool
    """its work switch is open"""
    remote: bool
    """level of its remote switch"""
    pwm: int
    """magnitude of what the motor gets, 0 to 255, without a sign"""


def decode_steer_reply(frame: Frame) -> SteerReply | None:
    """Return what a steer board reports; None: not such a message."""
    if (frame.source, frame.pgn, len(frame.data)) != (STEER_BOARD, Pgn.STEER_REPLY, 8):
        return None
    angle, _, _, switches, pwm = struct.unpack("<hhhBB", frame.data)
    return SteerReply(
        angle=-angle / _HUNDREDTHS,
        work_off=bool(switches & 1),
        steer_off=bool(switches & 2),
        remote=bool(switches & 4),
        pwm=pwm,
    )
