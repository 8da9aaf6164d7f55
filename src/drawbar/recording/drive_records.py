"""Records of a drive that are not its steps, as they lie in its log: raw bytes, order of what happened, messages."""

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any

import msgspec
from mcap.records import Metadata

from drawbar.errors import DrawbarError
from drawbar.messages import CommandMessage, ControllerState, Fixes, GateState, Message, OperatorMessage
from drawbar.recording.log import STEP_TOPIC, decode_step, missing_to_nan, reading
from drawbar.recording.stream import Logged, LoggedMessage
from drawbar.signals import StepRecord
from drawbar.transports.tapped import Direction

CLOCK = "clock"
"""metadata: `offset`, the computer's clock minus the monotonic one, ns"""
RAW, ORDER = "/raw/", "/order"
TOPICS: dict[type[Message], str] = {
    Fixes: "/fixes",
    CommandMessage: "/command",
    ControllerState: "/controller",
    GateState: "/gate",
    OperatorMessage: "/operator",
}
_KINDS = {topic: kind for kind, topic in TOPICS.items()}
_ORDER = struct.Struct("<BIQ")
_DIRECTIONS = tuple(Direction)


class Kind(IntEnum):
    """What happened in one of the processes; each tells in its own order."""

    LOOK = 0
    """the receivers' process looked at the receivers"""
    GATE = 1
    """the controller took in the gate's state of this sequence"""
    FIXES = 2
    """the controller took in the fixes of this sequence"""
    MISS = 3
    """the controller made a step without its fixes"""
    REPEAT = 4
    """the controller repeated its command"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Happening:
    """Something happened that a replay must do in the same order."""

    kind: Kind
    time: int
    """monotonic, ns"""
    sequence: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class RawBytes:
    """Bytes as they went over a device's wire."""

    device: str
    time: int
    """monotonic, ns"""
    direction: Direction
    data: bytes
    source: str = ""
    """`address:port` of the sender of a datagram"""


DriveRecord = StepRecord | Message | RawBytes | Happening


def pack_raw(raw: RawBytes) -> bytes:
    """Return the bytes with direction and sender in front; their time is the message's."""
    source = raw.source.encode()
    return bytes((_DIRECTIONS.index(raw.direction), len(source))) + source + raw.data


def pack_happening(happening: Happening) -> bytes:
    """Return kind, sequence and monotonic time."""
    return _ORDER.pack(happening.kind, happening.sequence, happening.time)


def pack_message(message: Message) -> bytes:
    """Return a record of one of the processes as JSON."""
    return msgspec.json.encode(asdict(message))


@contextmanager
def open_drive(file: Path) -> Iterator[Iterator[DriveRecord]]:
    """Read the records of a drive's log in the order in which they were written, as a context.

    Raises DrawbarError when the file cannot be read or is damaged; the iterator, when it is no log of a drive.
    """
    with reading(file) as records:
        yield _drive_records(records, file)


def is_drive(file: Path) -> bool:
    """Return whether a file is the log of a drive, with what a replay from raw bytes needs.

    Raises DrawbarError when it cannot be read.
    """
    with reading(file) as records:
        return next((True for record in records if isinstance(record, Metadata) and record.name == CLOCK), False)


def _drive_records(records: Iterator[Logged], file: Path) -> Iterator[DriveRecord]:
    offset: int | None = None
    for record in records:
        if isinstance(record, Metadata) and record.name == CLOCK:
            offset = int(record.metadata["offset"])
        elif isinstance(record, LoggedMessage):
            if offset is None:
                raise DrawbarError(f"{file}: is no log of a drive; give the log.mcap that drawbar drive wrote")
            decoded = _decoded(record.topic, record.data, record.publish_time - offset)
            if decoded is not None:
                yield decoded


def _decoded(topic: str, data: bytes, time: int) -> DriveRecord | None:
    if topic == STEP_TOPIC:
        return decode_step(data)
    if topic == ORDER:
        kind, sequence, time = _ORDER.unpack(data)
        return Happening(kind=Kind(kind), sequence=sequence, time=time)
    if topic.startswith(RAW):
        end = 2 + data[1]
        source, direction = data[2:end].decode(), _DIRECTIONS[data[0]]
        return RawBytes(device=topic[len(RAW) :], time=time, direction=direction, source=source, data=data[end:])
    if topic in _KINDS:
        content: Any = missing_to_nan(msgspec.json.decode(data))
        return msgspec.convert(content, _KINDS[topic])
    return None
