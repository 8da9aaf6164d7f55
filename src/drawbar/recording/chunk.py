"""Chunk of an MCAP file (https://mcap.dev/spec) that is written: readable while it grows, compressed where asked.

It grows uncompressed, behind a header with an impossible length, and is flushed to the operating system when the caller
asks. When it is full its header gets length and checksum; or one zstd frame takes its place, in steps after each of
which the file is whole. In the frame the messages of each channel stand together, in their order, which makes a drive's
log 5 % shorter (benchmark/log_channels.py). A killed process leaves a last chunk whose length is endless: readers
(stream.py) take what is there.
"""

import struct
import zlib
from collections.abc import Iterable
from io import SEEK_END, BytesIO
from typing import BinaryIO

import zstandard
from mcap.opcode import Opcode
from mcap.records import ChunkIndex

ENDLESS = 2**63 - 1
"""length of a chunk that is not complete"""
CHUNK_BYTES = 1 << 18
"""of messages, uncompressed, after which a chunk ends: what one damaged byte may cost"""
_WORTH = 16
"""part of a chunk that is enough to compress it at once rather than to write it twice, as it is and compressed"""
_WINDOW_LOG = 18
"""of zstd's window, which a whole chunk fits into: one that wraps within a chunk takes twice as long to search"""
BESIDE, VOID = 0x80, 0x81
"""operation codes, of those that are left to applications: of records that stand behind the chunks of older logs, with
columns for the report; and of one without meaning"""
COMPRESSION = "zstd"
Message = tuple[bytes, int, int, int]
"""data, sequence, and the times when it was measured and written, ns"""
LEVEL = -31
"""of the compression: it looks for repetitions every 32 bytes, a whole count of a step's numbers. Levels between lose
by that: -20 takes longer and leaves more"""
FRAME = struct.Struct("<BQ")
"""operation code of a record, and length of the content that follows"""
CHUNK_HEAD = struct.Struct("<BQQQQII")
"""opcode, length, first and last time, size uncompressed, its CRC, length of the compression's name, which follows"""
_COMPRESSED = struct.Struct("<Q")
"""size compressed"""
_HEADED = CHUNK_HEAD.size + _COMPRESSED.size - FRAME.size
_MESSAGE = struct.Struct("<BQHIQQ")
_AROUND = _MESSAGE.size - FRAME.size
"""bytes of a message's content beside its data"""
MESSAGE_CODE = int(Opcode.MESSAGE)  # looking up a member of the enumeration is slow, and messages are many


def compressor_of(level: int) -> zstandard.ZstdCompressor:
    """Return what compresses chunks at one of zstd's levels."""
    parameters = zstandard.ZstdCompressionParameters.from_level(level, window_log=_WINDOW_LOG, write_checksum=True)
    return zstandard.ZstdCompressor(compression_params=parameters)


def _message_index(channel: int, entries: list[int]) -> bytes:
    """Return the record of where messages lie: the time of each and its place, in turn."""
    size = 8 * len(entries)
    return struct.pack(f"<BQHI{len(entries)}Q", Opcode.MESSAGE_INDEX, 6 + size, channel, size, *entries)


class Chunk:
    """A chunk that grows at the end of a stream."""

    def __init__(self, stream: BinaryIO, compressor: zstandard.ZstdCompressor | None, records: BytesIO) -> None:
        """Take the stream, which is at its end, and memory to gather records in."""
        self._stream, self._compressor = stream, compressor
        self._messages: dict[int, list[int]] = {}
        self._records = records
        self._records.seek(0)
        self._start, self._written, self._crc = 0, 0, 0
        """where the chunk begins in the file, how many bytes of its records are there, uncompressed, and their CRC"""
        self.size = 0
        """bytes, uncompressed"""

    def add(self, channel: int, messages: Iterable[Message], before: bytes) -> int:
        """Append messages until the chunk is full; return how many."""
        pieces, places, size = list[bytes](), self._messages.setdefault(channel, []), self.size
        for data, sequence, log_time, publish_time in messages:
            length = _AROUND + len(before) + len(data)
            pieces += _MESSAGE.pack(MESSAGE_CODE, length, channel, sequence, log_time, publish_time), before, data
            places += log_time, size
            size += FRAME.size + length
            if size >= CHUNK_BYTES:
                break
        self._records.writelines(pieces)
        self.size = size
        return len(pieces) // 3

    @property
    def is_full(self) -> bool:
        """Whether it is to end."""
        return self.size >= CHUNK_BYTES

    @property
    def is_worth_compressing(self) -> bool:
        """Whether it is better ended, compressed, than written as it is and compressed later."""
        return bool(self._compressor) and not self._is_in_file and self.size >= CHUNK_BYTES // _WORTH

    @property
    def _is_in_file(self) -> bool:
        """Whether some of its records are."""
        return self._written > 0

    def flush(self) -> None:
        """Write what waits as it is."""
        if not self._is_in_file:
            self._start = self._stream.tell()
            self._stream.write(_chunk_head((0, 0), 0, 0, "", ENDLESS - _HEADED))
        with self._records.getbuffer() as records, records[self._written : self.size] as waiting:
            self._crc = zlib.crc32(waiting, self._crc)
            self._stream.write(waiting)
        self._written = self.size
        self._stream.flush()

    def counts(self) -> dict[int, int]:
        """Return how many messages it holds of each channel."""
        return {channel: len(entries) // 2 for channel, entries in self._messages.items()}

    def end(self) -> ChunkIndex:
        """Make it complete, the messages' index behind it; return the chunk's entry of the summary."""
        times = [entries[::2] for entries in self._messages.values()]
        span = min(map(min, times)), max(map(max, times))
        messages = self._messages
        if self._compressor:
            content, messages = self._by_channel()
            start, compressed = self._compress(self._compressor, content, span)
        else:
            start, compressed = self._close(span)
        behind = self._stream.seek(0, SEEK_END)
        indices, offsets = list[bytes](), {}
        for channel, entries in messages.items():
            offsets[channel] = behind + sum(map(len, indices))
            indices.append(_message_index(channel, entries))
        self._stream.write(b"".join(indices))
        self._stream.flush()
        return ChunkIndex(
            chunk_length=behind - start,
            chunk_start_offset=start,
            compression=COMPRESSION if self._compressor else "",
            compressed_size=compressed,
            message_start_time=span[0],
            message_end_time=span[1],
            message_index_length=sum(map(len, indices)),
            message_index_offsets=offsets,
            uncompressed_size=self.size,
        )

    def _close(self, span: tuple[int, int]) -> tuple[int, int]:
        """Write how long the chunk is; return where it begins, and the size of its records."""
        self.flush()
        head = _chunk_head(span, self.size, self._crc, "", self.size)
        _write(self._stream, self._start + FRAME.size, head[FRAME.size :])
        _write(self._stream, self._start, head[: FRAME.size])
        return self._start, self.size

    def _compress(self, compressor: zstandard.ZstdCompressor, records: bytes, span: tuple[int, int]) -> tuple[int, int]:
        """Write the records compressed; return where the chunk begins, and their size then."""
        content = compressor.compress(records)
        head = _chunk_head(span, self.size, 0, COMPRESSION, len(content))  # the frame has a checksum
        if self._is_in_file:
            self.flush()  # what takes its place is shorter then, and nothing stays void
            return _replace(self._stream, self._start, head + content), len(content)
        start = self._stream.tell()
        self._stream.writelines((head, content))
        return start, len(content)

    def _by_channel(self) -> tuple[bytes, dict[int, list[int]]]:
        """Return the records with those of a channel together, and where each lies then.

        Nothing of the chunk changes: who is interrupted here may end it once more.
        """
        with self._records.getbuffer() as buffer:
            records = bytes(buffer[: self.size])
        if len(self._messages) == 1:
            return records, self._messages
        together, moved, place = list[bytes](), dict[int, list[int]](), 0
        for channel, entries in self._messages.items():
            moved[channel] = entries.copy()
            for i in range(1, len(entries), 2):
                begin, (_, length) = entries[i], FRAME.unpack_from(records, entries[i])
                together.append(records[begin : begin + FRAME.size + length])
                moved[channel][i], place = place, place + FRAME.size + length
        return b"".join(together), moved


def _chunk_head(span: tuple[int, int], size: int, crc: int, compression: str, compressed: int) -> bytes:
    """Return the beginning of a chunk, up to its records."""
    name, length = compression.encode(), _HEADED + len(compression) + compressed
    return CHUNK_HEAD.pack(Opcode.CHUNK, length, *span, size, crc, len(name)) + name + _COMPRESSED.pack(compressed)


def _replace(stream: BinaryIO, start: int, record: bytes) -> int:
    """Put a record in the place of all that comes from a byte on; return where it begins: there, where it is shorter.

    Whenever this ends, the file holds one of both, and never both. The record is written behind; what was there becomes
    void, and only within that void the record is written once more before the void ends.
    """
    behind = stream.seek(0, SEEK_END)
    void = FRAME.pack(VOID, behind - start - FRAME.size)
    _write(stream, behind, record)
    _write(stream, start, void)
    if start + len(record) + FRAME.size > behind:
        stream.seek(0, SEEK_END)
        return behind
    _write(stream, start + FRAME.size, record[FRAME.size :] + void)
    _write(stream, start, record[: FRAME.size])
    stream.truncate(stream.seek(start + len(record)))
    return start


def _write(stream: BinaryIO, place: int, data: bytes) -> None:
    stream.seek(place)
    stream.write(data)
    stream.flush()
