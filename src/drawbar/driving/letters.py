"""Letters: what the processes of a drive send to its recorder, as datagrams with a kind in front.

Records of `messages.py` go as they are; they begin with their own mark. All times are monotonic, ns.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum

from drawbar.transports.tapped import Direction

_RAW = struct.Struct("<4sQBB")
_STEP = struct.Struct("<4sQ")
_DIRECTIONS = tuple(Direction)
RAW, STEP = b"DBr\0", b"DBs\0"


class Device(IntEnum):
    """Where bytes come from or go to."""

    TRACTOR_RECEIVER = 0
    TRAILER_RECEIVER = 1
    SENSORS = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Raw:
    """Bytes as they went over a wire."""

    time: int
    device: Device
    direction: Direction
    data: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """The record of a control step, as JSON."""

    time: int
    data: bytes


Letter = Raw | Step


def pack(letter: Letter) -> bytes:
    """Return the datagram of a letter."""
    if isinstance(letter, Raw):
        return _RAW.pack(RAW, letter.time, letter.device, _DIRECTIONS.index(letter.direction)) + letter.data
    return _STEP.pack(STEP, letter.time) + letter.data


def unpack(data: bytes) -> Letter | None:
    """Return the letter in a datagram; None: it is none."""
    try:
        if data[:4] == RAW:
            _, time, device, direction = _RAW.unpack_from(data)
            return Raw(time=time, device=Device(device), direction=_DIRECTIONS[direction], data=data[_RAW.size :])
        if data[:4] == STEP:
            return Step(time=_STEP.unpack_from(data)[1], data=data[_STEP.size :])
    except (ValueError, IndexError, struct.error):
        return None
    return None
