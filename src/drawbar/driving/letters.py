"""Letters: what the processes of a drive send to its recorder, as datagrams with a kind in front.

Records of `messages.py` go as they are; they begin with their own mark. All times are monotonic, ns.
"""

import json
import struct
from dataclasses import dataclass
from enum import Enum, IntEnum

from drawbar.transports.tapped import Direction

_RAW = struct.Struct("<4sQBB")
_STEP = struct.Struct("<4sQ")
_DIRECTIONS = tuple(Direction)
RAW, STEP, EVENT = b"DBr\0", b"DBs\0", b"DBe\0"


class Device(IntEnum):
    """Where bytes come from or go to."""

    TRACTOR_RECEIVER = 0
    TRAILER_RECEIVER = 1
    CORRECTIONS = 2
    SENSORS = 3


class Level(Enum):
    """How grave an event is."""

    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """Something to be told in words."""

    time: int
    level: Level
    name: str
    """of the process"""
    text: str


Letter = Raw | Step | Event


def pack(letter: Letter) -> bytes:
    """Return the datagram of a letter."""
    if isinstance(letter, Raw):
        return _RAW.pack(RAW, letter.time, letter.device, _DIRECTIONS.index(letter.direction)) + letter.data
    if isinstance(letter, Step):
        return _STEP.pack(STEP, letter.time) + letter.data
    words = {"level": letter.level.value, "name": letter.name, "text": letter.text}
    return _STEP.pack(EVENT, letter.time) + json.dumps(words).encode()


def unpack(data: bytes) -> Letter | None:
    """Return the letter in a datagram; None: it is none."""
    try:
        if data[:4] == RAW:
            _, time, device, direction = _RAW.unpack_from(data)
            return Raw(time=time, device=Device(device), direction=_DIRECTIONS[direction], data=data[_RAW.size :])
        if data[:4] == STEP:
            return Step(time=_STEP.unpack_from(data)[1], data=data[_STEP.size :])
        if data[:4] == EVENT:
            words = json.loads(data[_STEP.size :])
            time = _STEP.unpack_from(data)[1]
            return Event(time=time, level=Level(words["level"]), name=str(words["name"]), text=str(words["text"]))
    except (ValueError, KeyError, IndexError, struct.error):
        return None
    return None
