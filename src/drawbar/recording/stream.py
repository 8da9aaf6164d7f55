"""Stream of an MCAP file's records, read one after the other, also of a file that a crash cut off or that still grows.

Two chunks at a time are in memory: one is unpacked in a thread while the caller works on the records of the one before.
What a complete record or chunk holds is checked against its CRC where it has one.
"""

import struct
import zlib
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from io import SEEK_CUR, SEEK_END, BytesIO
from typing import BinaryIO, NamedTuple

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Metadata

from drawbar.recording.chunks import BESIDE, FRAME, MAGIC, VOID

_MESSAGE = struct.Struct("<HIQQ")
_CHUNK = struct.Struct("<QQQII")
_MESSAGE_CODE = int(Opcode.MESSAGE)  # comparing with a member of the enumeration is slow, and messages are many
_ANYWHERE = (Opcode.CHANNEL, Opcode.METADATA, Opcode.ATTACHMENT)
"""records that are read wherever they are"""
_ASIDE = (Opcode.MESSAGE_INDEX, BESIDE, VOID)
"""records that no message is in"""
_ZEROS = 64
"""at the end of a file, that nobody wrote: no compressed chunk ends so"""
_LARGEST = 1 << 32
"""bytes of a record that is not the last one, or of a chunk's records; more is damage"""
_PIECE = 1 << 24
"""bytes that are looked at together"""


class DamagedLogError(ValueError):
    """A record is not what its checksum or its length says."""


class LoggedMessage(NamedTuple):
    """A message of a channel."""

    topic: str
    """of the channel"""
    publish_time: int
    """ns since 1970"""
    data: bytes


Logged = LoggedMessage | Attachment | Metadata


def read_records(stream: BinaryIO, first_byte: int = 0) -> Iterator[Logged]:
    """Yield messages, attachments and metadata in the order in which they were written.

    Chunks and messages that begin before the `first_byte` of the stream are passed over.

    Raises:
        DamagedLogError: the file is none of MCAP, or damaged elsewhere than at its end.
        zstandard.ZstdError: a chunk is damaged.
    """
    if stream.read(len(MAGIC)) != MAGIC:
        raise DamagedLogError("it does not begin as an MCAP file does")
    topics: dict[int, str] = {}
    with ThreadPoolExecutor(1) as thread:
        before: _Frame | None = None
        for opcode, content, complete in _frames(stream, first_byte):
            unpacked = thread.submit(_unpacked, content, complete=complete) if opcode == Opcode.CHUNK else None
            if before is not None:
                yield from _of_frame(before, topics)
            before = _Frame(opcode, content, unpacked) if complete or unpacked else None
        if before is not None:
            yield from _of_frame(before, topics)


@dataclass(frozen=True, slots=True)
class _Frame:
    """A record as it stands in the file."""

    opcode: int
    content: bytes
    unpacked: Future[bytes] | None
    """of a chunk: the records in it"""


def _frames(stream: BinaryIO, first_byte: int) -> Iterator[tuple[int, bytes, bool]]:
    """Yield the operation code, the content and whether that is complete, of each record up to the summary.

    The indices of messages are left out: they stand between the chunks.
    """
    end = _written(stream)
    while (begin := stream.tell()) + FRAME.size <= end:
        opcode, length = FRAME.unpack(stream.read(FRAME.size))
        if opcode == Opcode.DATA_END:
            return
        if opcode in _ANYWHERE or (opcode not in _ASIDE and begin >= first_byte):
            content = stream.read(min(length, end - stream.tell()))
            yield opcode, content, len(content) == length
        else:
            stream.seek(min(length, _LARGEST), SEEK_CUR)


def _written(stream: BinaryIO) -> int:
    """Return how many bytes of a stream to read: all but zeros at its end, as a power cut leaves them."""
    before, end = stream.tell(), stream.seek(0, SEEK_END)
    stream.seek(max(end - _ZEROS, 0))
    if not any(stream.read(_ZEROS)):
        while end:
            start = stream.seek(max(end - _PIECE, 0))
            if found := stream.read(end - start).rstrip(b"\0"):
                end = start + len(found)
                break
            end = start
    stream.seek(before)
    return end


def records_beside_chunks(stream: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """Yield what stands beside each chunk of a log, and the byte where it ends; up to the first chunk with nothing."""
    if stream.read(len(MAGIC)) != MAGIC:
        return
    is_bare, end = False, _written(stream)
    while stream.tell() + FRAME.size <= end:
        opcode, length = FRAME.unpack(stream.read(FRAME.size))
        if opcode in (Opcode.DATA_END, Opcode.MESSAGE) or (is_bare and opcode == Opcode.CHUNK):
            return
        if opcode == BESIDE:
            is_bare, content = False, stream.read(min(length, end - stream.tell()))
            yield stream.tell(), content
        else:
            is_bare |= opcode == Opcode.CHUNK
            stream.seek(min(length, _LARGEST), SEEK_CUR)


def _of_frame(frame: _Frame, topics: dict[int, str]) -> Iterator[Logged]:
    if frame.unpacked is None:
        yield from _of_record(frame.opcode, frame.content, topics)
        return
    data, position = frame.unpacked.result(), 0
    while position + FRAME.size <= len(data):
        opcode, length = FRAME.unpack_from(data, position)
        position, end = position + FRAME.size, position + FRAME.size + length
        if end > len(data):
            return
        if opcode == _MESSAGE_CODE:
            yield _message(data, position, end, topics)
        elif opcode == Opcode.CHUNK:  # the same once more, which was about to take its place
            return
        else:
            yield from _of_record(opcode, data[position:end], topics)
        position = end


def _of_record(opcode: int, content: bytes, topics: dict[int, str]) -> Iterator[Logged]:
    if opcode == _MESSAGE_CODE:
        yield _message(content, 0, len(content), topics)
    elif opcode == Opcode.CHANNEL:
        opened = Channel.read(_stream(content))
        topics[opened.id] = opened.topic
    elif opcode == Opcode.ATTACHMENT:
        if zlib.crc32(memoryview(content)[:-4]) != int.from_bytes(content[-4:], "little"):
            raise DamagedLogError("an attachment does not match its checksum")
        yield Attachment.read(_stream(content))
    elif opcode == Opcode.METADATA:
        yield Metadata.read(_stream(content))


def _message(data: bytes, start: int, end: int, topics: dict[int, str]) -> LoggedMessage:
    """Return the message whose content is data[start:end]."""
    channel, _, _, publish_time = _MESSAGE.unpack_from(data, start)
    return LoggedMessage(topics.get(channel, ""), publish_time, data[start + _MESSAGE.size : end])


def _stream(content: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(content))


def _unpacked(content: bytes, *, complete: bool) -> bytes:
    """Return the records of a chunk; of one that a crash left incomplete what is whole."""
    if len(content) < _CHUNK.size:
        return b""
    _, _, size, crc, named = _CHUNK.unpack_from(content)
    if not complete and len(content) < _CHUNK.size + named + 8:  # cut within its head
        return b""
    compression, packed = content[_CHUNK.size : _CHUNK.size + named], memoryview(content)[_CHUNK.size + named + 8 :]
    if compression not in (b"", b"zstd"):
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
