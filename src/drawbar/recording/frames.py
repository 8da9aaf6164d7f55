"""Frames of an MCAP file: its records as they stand in it, also behind bytes that are damaged.

A frame is accepted where what it holds agrees with its length, or where another frame follows it. Behind one that is
not, the next sound chunk is looked for, or the outcome; what lies between counts as damage. A crash cuts the
last frame off and leaves no magic at the end; in a file that ends with it, a frame without an end is damage too.
"""

import re
import struct
import zlib
from collections.abc import Iterator
from io import SEEK_END, BytesIO
from typing import Any, BinaryIO, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Header, Metadata, Schema

from drawbar.recording.chunk import BESIDE, ENDLESS, FRAME, VOID
from drawbar.recording.chunked_writer import MAGIC

CHUNK = struct.Struct("<QQQII")
"""first and last time, size uncompressed, its CRC, length of the compression's name; that and the size follow"""
_SIZE = struct.Struct("<Q")
_PARSED: dict[int, Any] = {
    Opcode.HEADER: Header,
    Opcode.SCHEMA: Schema,
    Opcode.CHANNEL: Channel,
    Opcode.ATTACHMENT: Attachment,
    Opcode.METADATA: Metadata,
}
_LENGTHS: dict[int, int] = {Opcode.DATA_END: 4, Opcode.FOOTER: 20}
_CODES = {*_PARSED, *_LENGTHS, Opcode.MESSAGE, Opcode.CHUNK, Opcode.MESSAGE_INDEX, BESIDE, VOID}
_ASIDE = (Opcode.HEADER, Opcode.MESSAGE_INDEX, BESIDE, VOID)
"""records that no message is in"""
_KNOWN = re.compile(
    rb"(?s)(?="
    rb"\x06.{24}(.{4}\0{4}).{4}(?:\x04\0\0\0zstd|\0{4}\1)"  # a chunk, compressed or of the same size twice
    rb"|" + re.escape(FRAME.pack(Opcode.CHUNK, ENDLESS)) + rb"|\x0c.{8}\x07\0\0\0outcome)"
)
"""what frames are known by"""
_ZEROS = 64
"""at the end of a file, that nobody wrote: no record ends so"""
_PIECE = 1 << 24
"""bytes that are looked at together"""


class DamagedLogError(ValueError):
    """A record contradicts its checksum or its length."""


class Damage(NamedTuple):
    """Bytes of a file that cannot be read."""

    begin: int
    end: int

    def __str__(self) -> str:
        """Return where they are; none: where some are missing."""
        if self.begin == self.end:
            return f"bytes may be missing before byte {self.begin}"
        return f"bytes {self.begin} to {self.end - 1} are damaged"


class Frame(NamedTuple):
    """A record as it stands in a file."""

    begin: int
    """byte of the file"""
    opcode: int
    content: bytes
    is_complete: bool


def frames(stream: BinaryIO) -> Iterator[Frame | Damage]:
    """Yield what a file holds up to its summary, but for the indices of messages. The last frame may be incomplete.

    Raises DamagedLogError: the file is none of MCAP.
    """
    written = _written(stream)
    if not written:
        raise DamagedLogError("it is empty, as a full disk or a power cut leaves one")
    stream.seek(0)
    magic = stream.read(len(MAGIC))
    if sum(here != there for here, there in zip(magic, MAGIC, strict=False)) + len(MAGIC) - len(magic) > 1:
        raise DamagedLogError("it does not begin as an MCAP file does")
    is_finished = _is_finished(stream, written)
    end = written - len(MAGIC) if is_finished else written
    begin = len(MAGIC)
    while begin + FRAME.size <= end:
        opcode, length = _head(stream, begin)
        behind = begin + FRAME.size + length
        is_sound = _is_sound(stream, begin, end)
        if is_sound and opcode in _LENGTHS:
            if is_finished and not _is_in_place(stream, behind, end):
                yield Damage(begin, begin)
            return
        found = None if is_sound and _is_all_there(stream, begin, end) else _next_sound(stream, begin + 1, end)
        if found is not None and (not is_sound or found < behind):
            yield Damage(begin, found)
            begin = found
        elif is_sound:
            if opcode not in _ASIDE:
                yield _frame(stream, begin, end)
            begin = min(behind, end)
        elif opcode in _CODES and behind > end and not is_finished:  # a crash cut it off
            yield _frame(stream, begin, end)
            return
        else:
            break
    if is_finished or begin + FRAME.size <= end:
        yield Damage(begin, written)


def _is_finished(stream: BinaryIO, written: int) -> bool:
    """Return whether a file ends as one does that was not cut off."""
    stream.seek(max(written - len(MAGIC), len(MAGIC)))
    return stream.read(len(MAGIC)) == MAGIC


def _is_in_place(stream: BinaryIO, behind: int, end: int) -> bool:
    """Return whether the summary, if there is one, begins where the footer points."""
    stream.seek(max(end - _LENGTHS[Opcode.FOOTER], 0))
    (start,) = _SIZE.unpack(stream.read(_SIZE.size))
    return start in (0, behind)


def _head(stream: BinaryIO, begin: int) -> tuple[int, int]:
    """Return the operation code of a frame, and the length of its content."""
    stream.seek(begin)
    opcode, length = FRAME.unpack(stream.read(FRAME.size))
    return opcode, length


def _frame(stream: BinaryIO, begin: int, end: int) -> Frame:
    opcode, length = _head(stream, begin)
    content = stream.read(min(length, end - begin - FRAME.size))
    return Frame(begin, opcode, content, len(content) == length)


def _is_sound(stream: BinaryIO, begin: int, end: int) -> bool:
    """Return whether a frame is intact."""
    opcode, length = _head(stream, begin)
    if opcode == Opcode.CHUNK and length == ENDLESS:
        return True
    if opcode not in _CODES or begin + FRAME.size + length > end or _LENGTHS.get(opcode, length) != length:
        return False
    if opcode == Opcode.CHUNK:
        return _is_chunk(stream.read(min(length, 2 * CHUNK.size)), length)
    if opcode == Opcode.MESSAGE_INDEX:
        return stream.read(6)[2:] == struct.pack("<I", (length - 6) % 2**32)
    if opcode in _PARSED:
        return _is_whole(_PARSED[opcode], stream.read(length))
    return opcode in _LENGTHS or _may_follow(stream, begin + FRAME.size + length, end)


def _is_all_there(stream: BinaryIO, begin: int, end: int) -> bool:
    """Return whether a sound frame, if it is a chunk, lacks none of its bytes."""
    opcode, length = _head(stream, begin)
    return opcode != Opcode.CHUNK or _may_follow(stream, begin + FRAME.size + length, end)


def _is_chunk(head: bytes, length: int) -> bool:
    """Return whether the lengths in a chunk agree with its own."""
    if len(head) < CHUNK.size:
        return False
    before: int = CHUNK.size + CHUNK.unpack_from(head)[-1] + _SIZE.size
    if before > len(head):
        return False
    (size,) = _SIZE.unpack_from(head, before - _SIZE.size)
    return bool(before + size == length)


def _is_whole(kind: Any, content: bytes) -> bool:
    """Return whether a record ends where its content does."""
    stream = ReadDataStream(BytesIO(content))
    try:
        kind.read(stream)
    except (McapError, ValueError, struct.error, MemoryError, OverflowError):
        return False
    return bool(stream.count == len(content))


def _may_follow(stream: BinaryIO, begin: int, end: int) -> bool:
    """Return whether a frame, or the file's end, may be there."""
    return begin + FRAME.size > end or _head(stream, begin)[0] in _CODES


def _next_sound(stream: BinaryIO, begin: int, end: int) -> int | None:
    """Return where the next frame that is known by what it holds begins; None: there is none."""
    while begin < end:
        stream.seek(begin)
        piece = stream.read(_PIECE)
        for found in _KNOWN.finditer(piece):
            if _is_sound(stream, begin + found.start(), end):
                return begin + found.start()
        begin += max(len(piece) - 64, 1)  # what lies across the border of two pieces is in the next
    return None


def _written(stream: BinaryIO) -> int:
    """Return how many bytes of a stream to read: all but zeros at its end, as a power cut leaves them."""
    end = stream.seek(0, SEEK_END)
    stream.seek(max(end - _ZEROS, 0))
    if not any(stream.read(_ZEROS)):
        while end:
            start = stream.seek(max(end - _PIECE, 0))
            if found := stream.read(end - start).rstrip(b"\0"):
                return start + len(found)
            end = start
    return end


def summary(stream: BinaryIO) -> Iterator[Schema | Channel]:
    """Yield the schemas and channels that the summary of a file repeats; nothing where that is missing or damaged."""
    size = FRAME.size + _LENGTHS[Opcode.FOOTER] + len(MAGIC)
    end = stream.seek(0, SEEK_END) - size
    stream.seek(max(end, 0))
    footer = stream.read(size)
    if end < 0 or footer[: FRAME.size] != FRAME.pack(Opcode.FOOTER, _LENGTHS[Opcode.FOOTER]):
        return
    start, _, crc = struct.unpack_from("<QQI", footer, FRAME.size)
    if not len(MAGIC) <= start <= end:
        return
    stream.seek(start)
    content, at = stream.read(end - start), 0
    if zlib.crc32(footer[: FRAME.size + 16], zlib.crc32(content)) != crc:
        return
    while at < len(content):
        opcode, length = FRAME.unpack_from(content, at)
        if opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
            yield _PARSED[opcode].read(ReadDataStream(BytesIO(content[at + FRAME.size :])))
        at += FRAME.size + length
