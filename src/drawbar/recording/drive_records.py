"""Records of a drive that are not its steps, as they lie in its log: raw bytes, order of what happened, messages."""

import struct
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

import msgspec
from mcap.records import Metadata

from drawbar.errors import DrawbarError
from drawbar.messages import CommandMessage, ControllerState, Fixes, GateState, Message, OperatorMessage
from drawbar.recording.encoding import decode_message, decode_step
from drawbar.recording.frames import Damage
from drawbar.recording.log import OUTCOME_NAME, STEP_TOPIC, Outcome, outcome_of, reading
from drawbar.recording.stream import Logged, LoggedMessage
from drawbar.signals import StepRecord
from drawbar.transports.tapped import DIRECTIONS, Direction

CLOCK = "clock"
"""metadata: `offset`, the computer's clock minus the monotonic one, ns"""
RAW, ORDER = "/raw", "/order"
TOPICS: dict[type[Message], str] = {
    Fixes: "/fixes",
    CommandMessage: "/command",
    ControllerState: "/controller",
    GateState: "/gate",
    OperatorMessage: "/operator",
}
_KINDS = {topic: kind for kind, topic in TOPICS.items()}
_ORDER = struct.Struct("<BIQ")
_RAW = struct.Struct("<QBBBI")


class Kind(IntEnum):
    """What happened in one of the processes; each reports in its own order."""

    LOOK = 0
    """the receivers' process looked at the receivers, and read as many pieces as `sequence`"""
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


@dataclass(frozen=True, slots=True)
class Order:
    """What happened: in each process one after the other."""

    happenings: tuple[Happening, ...]

    @property
    def time(self) -> int:
        """Of the last, monotonic, ns."""
        return self.happenings[-1].time


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


DriveRecord = StepRecord | Message | RawBytes | Happening | Damage | Outcome


def pack_raw(pieces: Iterable[RawBytes]) -> bytes:
    """Return, of each: time, direction, three lengths, the device's name, the sender and the bytes."""
    packed = []
    for raw in pieces:
        texts = raw.device.encode(), raw.source.encode(), raw.data
        packed += [_RAW.pack(raw.time, DIRECTIONS.index(raw.direction), *map(len, texts)), *texts]
    return b"".join(packed)


def unpack_raw(data: bytes) -> Iterator[RawBytes]:
    """Yield what `pack_raw` packed; struct.error, IndexError or UnicodeError: it is none."""
    at = 0
    while at < len(data):
        time, direction, *lengths = _RAW.unpack_from(data, at)
        at += _RAW.size
        texts = [data[at : (at := at + length)] for length in lengths]
        device, source, content = texts[0].decode(), texts[1].decode(), texts[2]
        yield RawBytes(device=device, time=time, direction=DIRECTIONS[direction], source=source, data=content)


def pack_order(order: Order) -> bytes:
    """Return kind, sequence and monotonic time of each."""
    return b"".join(_ORDER.pack(each.kind, each.sequence, each.time) for each in order.happenings)


def unpack_order(data: bytes) -> Order:
    """Return what `pack_order` packed; struct.error or ValueError: it is none."""
    if not data:
        raise ValueError("nothing has happened")
    entries = _ORDER.iter_unpack(data)
    return Order(tuple(Happening(kind=Kind(kind), sequence=count, time=time) for kind, count, time in entries))


@contextmanager
def open_drive(file: Path) -> Iterator[Iterator[DriveRecord]]:
    """Read the records of a drive's log as a context; those of a kind in the order in which they were written.

    Raises DrawbarError when the file cannot be read or is damaged; the iterator, when it is no log of a drive.
    """
    with reading(file) as records:
        yield _drive_records(records, file)


def read_messages(file: Path, *kinds: type[Message]) -> Iterator[tuple[float, Message]]:
    """Yield the messages of some kinds in a log, each with its time, s since the epoch, as they stand in the file.

    Raises DrawbarError when the file cannot be read or is damaged.
    """
    wanted = {TOPICS[kind]: kind for kind in kinds}
    with reading(file) as records:
        for each in records:
            if isinstance(each, LoggedMessage) and each.topic in wanted:
                yield each.publish_time * 1e-9, msgspec.convert(decode_message(each), wanted[each.topic])


def is_drive(file: Path) -> bool:
    """Return whether a file is the log of a drive, with what a replay from raw bytes needs.

    Raises DrawbarError when it cannot be read.
    """
    with reading(file) as records:
        return next((True for record in records if isinstance(record, Metadata) and record.name == CLOCK), False)


def _drive_records(records: Iterator[Logged], file: Path) -> Iterator[DriveRecord]:
    offset: int | None = None
    for record in records:
        if isinstance(record, Damage):
            yield record
        elif isinstance(record, Metadata) and record.name == CLOCK:
            offset = int(record.metadata["offset"])
        elif isinstance(record, Metadata) and record.name == OUTCOME_NAME and (outcome := outcome_of(record.metadata)):
            yield outcome
        elif isinstance(record, LoggedMessage):
            if offset is None:
                raise DrawbarError(f"{file}: is no log of a drive; give the log.mcap that drawbar drive wrote")
            if record.topic.startswith(f"{RAW}/"):
                raise DrawbarError(f"{file}: an earlier drawbar wrote it, in another layout; use that one")
            yield from _decoded(record)


def _decoded(message: LoggedMessage) -> Iterator[DriveRecord]:
    topic, data = message.topic, message.data
    if topic == STEP_TOPIC:
        yield decode_step(message)
    elif topic == ORDER:
        yield from unpack_order(data).happenings
    elif topic == RAW:
        yield from unpack_raw(data)
    elif topic in _KINDS:
        yield msgspec.convert(decode_message(message), _KINDS[topic])
