"""Stream of an MCAP file's records, read one after the other, also of a file that a crash cut off or that still grows.

Two chunks at a time are in memory: one is unpacked in a thread while the caller works on the records of the one before.
What a complete record or chunk holds is checked against its CRC where it has one. What is damaged is passed over, and
told.
"""

import struct
import zlib
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from io import BytesIO
from typing import BinaryIO, NamedTuple

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Metadata, Schema

from drawbar.recording.chunk import COMPRESSION, FRAME, MESSAGE_CODE
from drawbar.recording.frames import CHUNK, Damage, DamagedLogError, Frame, frames, summary

_MESSAGE = struct.Struct("<HIQQ")
_LARGEST = 1 << 32
"""bytes of a chunk's records; more is damage"""


class LoggedMessage(NamedTuple):
    """A message of a channel."""

    topic: str
    """of the channel"""
    sequence: int
    """of the message"""
    publish_time: int
    """ns since 1970"""
    data: bytes
    schema: str
    """of the channel; empty: it has none"""


Logged = LoggedMessage | Attachment | Metadata | Damage


def read_records(stream: BinaryIO) -> Iterator[Logged]:
    """Yield messages, attachments and metadata as they stand in the file, and damage where it is.

    Messages of a channel come in the order in which they were written, those of different channels may not.

    An attachment that does not match its checksum comes behind its damage.

    Raises DamagedLogError: the file is none of MCAP.
    """
    channels = _Channels(summary(stream))
    with ThreadPoolExecutor(1) as thread:
        before: _Waiting | None = None
        for frame in frames(stream):
            unpacked = None
            if isinstance(frame, Frame) and frame.opcode == Opcode.CHUNK:
                unpacked = thread.submit(_unpacked, frame.content, complete=frame.is_complete)
            if before is not None:
                yield from _records(before, channels)
            before = _Waiting(frame, unpacked)
        if before is not None:
            yield from _records(before, channels)


@dataclass(frozen=True, slots=True)
class _Waiting:
    """What is read from the file, and not looked at yet."""

    frame: Frame | Damage
    unpacked: Future[bytes] | None
    """of a chunk: the records in it"""


class _Channels:
    """The channels that were opened."""

    def __init__(self, repeated: Iterator[Schema | Channel]) -> None:
        """Take what the summary repeats, which has a checksum."""
        self.known: dict[int, tuple[str, str]] = {}
        """topic and schema, by number"""
        self._schemas: dict[int, str] = {}
        self._is_sure = False
        for record in repeated:
            self.add(record)
        self._is_sure = bool(self.known)

    def add(self, record: Schema | Channel) -> None:
        if self._is_sure:
            return
        if isinstance(record, Schema):
            self._schemas[record.id] = record.data.decode(errors="replace")
        else:
            self.known[record.id] = record.topic, self._schemas.get(record.schema_id, "")


def _records(waiting: _Waiting, channels: _Channels) -> Iterator[Logged]:
    frame = waiting.frame
    if isinstance(frame, Damage):
        yield frame
    elif waiting.unpacked is not None:
        yield from _of_chunk(frame, waiting.unpacked, channels)
    elif frame.is_complete:
        yield from _of_record(frame, channels)


def _of_chunk(frame: Frame, unpacked: "Future[bytes]", channels: _Channels) -> Iterator[Logged]:
    whole, position = Damage(frame.begin, frame.begin + FRAME.size + len(frame.content)), 0
    try:
        data = unpacked.result()
    except (zstandard.ZstdError, DamagedLogError):
        yield whole
        return
    while position + FRAME.size <= len(data):
        opcode, length = FRAME.unpack_from(data, position)
        begin, position = position + FRAME.size, position + FRAME.size + length
        if opcode == Opcode.CHUNK:  # the same once more, which was about to take its place
            return
        if opcode == MESSAGE_CODE and length >= _MESSAGE.size:
            if position <= len(data):  # else a crash cut it off
                yield _message(data, begin, position, channels)
        elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            yield from _of_record(Frame(frame.begin, opcode, data[begin:position], True), channels)
        else:
            yield whole
            return


def _of_record(frame: Frame, channels: _Channels) -> Iterator[Logged]:
    opcode, content = frame.opcode, frame.content
    if opcode == MESSAGE_CODE:
        yield _message(content, 0, len(content), channels)
    elif opcode == Opcode.CHANNEL:
        channels.add(Channel.read(_stream(content)))
    elif opcode == Opcode.SCHEMA:
        channels.add(Schema.read(_stream(content)))
    elif opcode == Opcode.ATTACHMENT:
        if zlib.crc32(memoryview(content)[:-4]) != int.from_bytes(content[-4:], "little"):
            yield Damage(frame.begin, frame.begin + FRAME.size + len(content))
        yield Attachment.read(_stream(content))
    elif opcode == Opcode.METADATA:
        yield Metadata.read(_stream(content))


def _message(data: bytes, start: int, end: int, channels: _Channels) -> LoggedMessage:
    """Return the message whose content is data[start:end]."""
    channel, sequence, _, publish_time = _MESSAGE.unpack_from(data, start)
    topic, schema = channels.known.get(channel, ("", ""))
    return LoggedMessage(topic, sequence, publish_time, data[start + _MESSAGE.size : end], schema)


def _stream(content: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(content))


def _unpacked(content: bytes, *, complete: bool) -> bytes:
    """Return the records of a chunk; of one that a crash left incomplete what is whole."""
    if len(content) < CHUNK.size:
        return b""
    _, _, size, crc, named = CHUNK.unpack_from(content)
    if not complete and len(content) < CHUNK.size + named + 8:  # cut within its head
        return b""
    compression, packed = content[CHUNK.size : CHUNK.size + named], memoryview(content)[CHUNK.size + named + 8 :]
    if compression not in (b"", COMPRESSION.encode()):
        raise DamagedLogError(f"a chunk is compressed by {compression!r}, which drawbar does not write")
    data = _decompressed(packed, size if complete else None) if compression and packed else bytes(packed)
    if complete and (len(data) != size or (crc and zlib.crc32(data) != crc)):
        raise DamagedLogError("a chunk does not match its checksum")
    return data


def _decompressed(packed: memoryview, size: int | None) -> bytes:
    """Return what a zstd frame holds: of a known size, or, if that is None, of a frame that may be cut.

    The known size takes one call, in which other threads work on; the other way asks for the interpreter's lock at each
    128 KiB, and waits for it while another thread decodes.
    """
    decompressor = zstandard.ZstdDecompressor()
    if size is None:
        return decompressor.decompressobj().decompress(packed)
    if size > _LARGEST:
        raise DamagedLogError("a chunk has another length than it states")
    return decompressor.decompress(packed, max_output_size=size)
