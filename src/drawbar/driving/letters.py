"""Letters: what the processes of a drive send to its recorder or console, as datagrams with a kind in front.

Records of `message_records.py` go as they are; they begin with their own mark. All times are monotonic, ns.
"""

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import msgspec

from drawbar.recording.drive_records import Order, RawBytes, pack_order, unpack_order
from drawbar.transports.tapped import Direction

_RAW = struct.Struct("<4sQBBB")
_STEP = struct.Struct("<4sQ")
_DIRECTIONS = tuple(Direction)
RAW, STEP, ORDER, SURE = b"DBr\0", b"DBs\0", b"DBo\0", b"DBv\0"


class Device(IntEnum):
    """Where bytes come from or go to."""

    TRACTOR_RECEIVER = 0
    TRAILER_RECEIVER = 1
    SENSORS = 2

    @property
    def topic(self) -> str:
        """Its name in logs."""
        return self.name.lower()


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """The record of a control step, as its bytes."""

    time: int
    data: bytes


@dataclass(frozen=True, slots=True)
class Sureness:
    """How sure the estimate of the step that follows is: standard deviations by the names of its fields."""

    deviations: Mapping[str, float]


Letter = RawBytes | Step | Order | Sureness


def pack(letter: Letter) -> bytes:
    """Return the datagram of a letter."""
    if isinstance(letter, RawBytes):
        device, source = Device[letter.device.upper()], letter.source.encode()
        direction = _DIRECTIONS.index(letter.direction)
        return _RAW.pack(RAW, letter.time, device, direction, len(source)) + source + letter.data
    if isinstance(letter, Order):
        return ORDER + pack_order(letter)
    if isinstance(letter, Sureness):
        return SURE + msgspec.json.encode(letter.deviations)
    return _STEP.pack(STEP, letter.time) + letter.data


def unpack(data: bytes) -> Letter | None:
    """Return the letter in a datagram; None: it is none."""
    try:
        if data[:4] == RAW:
            return _unpack_raw(data)
        if data[:4] == STEP:
            return Step(time=_STEP.unpack_from(data)[1], data=data[_STEP.size :])
        if data[:4] == ORDER:
            return unpack_order(data[4:])
        if data[:4] == SURE:
            return Sureness(msgspec.json.decode(data[4:], type=dict[str, float]))
    except (ValueError, IndexError, struct.error):
        return None
    return None


def _unpack_raw(data: bytes) -> RawBytes:
    _, time, device, direction, length = _RAW.unpack_from(data)
    end = _RAW.size + length
    return RawBytes(
        time=time,
        device=Device(device).topic,
        direction=_DIRECTIONS[direction],
        source=data[_RAW.size : end].decode(),
        data=data[end:],
    )
