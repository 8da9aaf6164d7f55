"""Frame: the envelope of every AgOpenGPS message, `80 81 source PGN length data checksum`.

The checksum is the low byte of the sum of all bytes from the source to the last one of the data; some messages carry
the constant 0x47 instead, and current boards drop them with a right sum there.
"""

import math
from dataclasses import dataclass
from enum import Enum, IntEnum

from drawbar.errors import HardwareError

PREFIX = b"\x80\x81"
CONSTANT = 0x47
"""last byte of greetings and of their replies, where other messages have their checksum"""
COMPUTER = 0x7F
"""source of what a computer sends"""
STEER_BOARD = 0x7E
"""source of what a steer board sends"""


class Pgn(IntEnum):
    """The messages drawbar reads or writes."""

    IMU_HELLO_REPLY = 121
    MACHINE_HELLO_REPLY = 123
    STEER_HELLO_REPLY = 126
    HELLO = 200
    SUBNET = 201
    SCAN = 202
    SCAN_REPLY = 203
    TEXT = 221
    SENSOR = 250
    STEER_CONFIG = 251
    STEER_SETTINGS = 252
    STEER_REPLY = 253
    STEER = 254


GREETINGS = frozenset((Pgn.HELLO, Pgn.SUBNET, Pgn.SCAN))
"""what a computer sends with the constant as its last byte"""
_CONSTANT_ALLOWED = GREETINGS | {Pgn.STEER_HELLO_REPLY, Pgn.MACHINE_HELLO_REPLY, Pgn.IMU_HELLO_REPLY}


@dataclass(frozen=True, slots=True)
class Frame:
    """One message."""

    source: int
    pgn: int
    data: bytes


class Refusal(Enum):
    """Why a datagram is no message."""

    SHORT = "shorter than the smallest message"
    FOREIGN = "does not begin with 80 81"
    LENGTH = "its length byte does not fit its length"
    CHECKSUM = "wrong checksum"


def checksum(frame: bytes) -> int:
    """Return the checksum of a frame of which all but the checksum is given."""
    return sum(frame[2:]) & 0xFF


def pack(source: int, pgn: int, data: bytes) -> bytes:
    """Return the datagram of a message, with its checksum or, for greetings, with the constant."""
    frame = PREFIX + bytes((source, pgn, len(data))) + data
    return frame + bytes((CONSTANT if pgn in GREETINGS else checksum(frame),))


def parse(datagram: bytes) -> Frame | Refusal:
    """Return the message in a datagram, or why there is none. Takes any bytes; never raises."""
    if len(datagram) < 6:
        return Refusal.SHORT
    if datagram[:2] != PREFIX:
        return Refusal.FOREIGN
    if datagram[4] != len(datagram) - 6:
        return Refusal.LENGTH
    pgn = datagram[3]
    constant = pgn in _CONSTANT_ALLOWED and datagram[-1] == CONSTANT
    if not constant and datagram[-1] != checksum(datagram[:-1]):
        return Refusal.CHECKSUM
    return Frame(datagram[2], pgn, datagram[5:-1])


def scaled(name: str, value: float, scale: float, lowest: int, highest: int) -> int:
    """Return `value * scale` rounded to the nearest integer of the wire.

    Raises HardwareError when the value is not finite or does not fit; nothing is clamped.
    """
    if not math.isfinite(value):
        raise HardwareError(f"{name} is {value}; a frame holds finite numbers only; check what computed it")
    counts = round(value * scale)
    if not lowest <= counts <= highest:
        raise HardwareError(
            f"{name} is {value:g}; a frame holds {lowest / scale:g} to {highest / scale:g}; bring it into that range"
        )
    return counts


def byte(name: str, value: int, lowest: int = 0, highest: int = 255) -> int:
    """Return the value of one byte; raises HardwareError when it is outside of what is allowed."""
    if not lowest <= value <= highest:
        raise HardwareError(f"{name} is {value}; allowed are {lowest} to {highest}; choose one of them")
    return value
