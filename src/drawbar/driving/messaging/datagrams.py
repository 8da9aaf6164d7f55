"""Datagrams that the processes of a drive send to its recorder or console, each with its kind in front.

Records of `messages/records.py` go as they are; they begin with their own mark. All times are monotonic, ns.
"""

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import msgspec

from drawbar.recording.drive_records import Order, RawBytes, pack_order, unpack_order
from drawbar.transports.tapped import DIRECTIONS

_RAW = struct.Struct("<4sQBBB")
_STEP = struct.Struct("<4sQ")
RAW, STEP, ORDER, DEVIATIONS, CORRECTIONS = b"DBr\0", b"DBs\0", b"DBo\0", b"DBv\0", b"DBc\0"


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
class PackedStep:
    """The record of a control step, as its bytes."""

    time: int
    data: bytes


@dataclass(frozen=True, slots=True)
class EstimateDeviations:
    """Standard deviations of the estimate of the step that follows, by the names of its fields."""

    deviations: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class CorrectionsFailure:
    """Why no corrections come, and what to do; empty: they come."""

    text: str


Content = RawBytes | PackedStep | Order | EstimateDeviations | CorrectionsFailure
"""of a datagram"""


def pack(content: Content) -> bytes:
    """Return the datagram with a content."""
    if isinstance(content, RawBytes):
        device, source = Device[content.device.upper()], content.source.encode()
        direction = DIRECTIONS.index(content.direction)
        return _RAW.pack(RAW, content.time, device, direction, len(source)) + source + content.data
    if isinstance(content, Order):
        return ORDER + pack_order(content)
    if isinstance(content, EstimateDeviations):
        return DEVIATIONS + msgspec.json.encode(content.deviations)
    if isinstance(content, CorrectionsFailure):
        return CORRECTIONS + content.text.encode()
    return _STEP.pack(STEP, content.time) + content.data


def unpack(data: bytes) -> Content | None:
    """Return the content of a datagram; None: it is none of these."""
    try:
        if data[:4] == RAW:
            return _unpack_raw(data)
        if data[:4] == STEP:
            return PackedStep(time=_STEP.unpack_from(data)[1], data=data[_STEP.size :])
        if data[:4] == ORDER:
            return unpack_order(data[4:])
        if data[:4] == DEVIATIONS:
            return EstimateDeviations(msgspec.json.decode(data[4:], type=dict[str, float]))
        if data[:4] == CORRECTIONS:
            return CorrectionsFailure(data[4:].decode())
    except (ValueError, IndexError, struct.error):
        return None
    return None


def _unpack_raw(data: bytes) -> RawBytes:
    _, time, device, direction, length = _RAW.unpack_from(data)
    end = _RAW.size + length
    return RawBytes(
        time=time,
        device=Device(device).topic,
        direction=DIRECTIONS[direction],
        source=data[_RAW.size : end].decode(),
        data=data[end:],
    )
