"""Chunks of an MCAP file (https://mcap.dev/spec) that is written: readable while they grow, compressed where asked.

A chunk grows as it is, behind a header with an impossible length; what has come is flushed to the operating system when
the caller asks. When the chunk is full its header tells length and checksum; or one zstd frame takes its place, in
steps after each of which the file is whole; in the frame the messages of each channel stand together, as they came,
which is 8 % shorter in a drive's log.
A killed process leaves a last chunk that says it is endless: readers (stream.py) take from it what is there.
"""

import struct
import zlib
from collections.abc import Iterable, Mapping, Sequence
from io import SEEK_END, BytesIO
from typing import BinaryIO

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

MAGIC = b"\x89MCAP0\r\n"
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
columns for the report; and of one that tells nothing"""
COMPRESSION = "zstd"
Message = tuple[bytes, int, int, int]
"""data, sequence, and the times when it was measured and written, ns"""
LEVEL = -31
"""of the compression: it looks for what it knows every 32 bytes, a whole count of a step's numbers. Levels between lose
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
_MESSAGE_CODE = int(Opcode.MESSAGE)  # looking up a member of the enumeration is slow, and messages are many


class ChunkedWriter:
    """Puts records into a seekable stream that is at its beginning; the caller opens and closes it."""

    def __init__(self, stream: BinaryIO, profile: str, level: int | None = None) -> None:
        """Write the magic and the header.

        Args:
            stream: to be written.
            profile: of MCAP.
            level: zstd's, of the chunks; None: they stay as they are.
        """
        self._stream = stream
        self._compressor = None if level is None else _compressor(level)
        self._chunk: _Chunk | None = None
        self._records = BytesIO()
        """of the chunk; its memory serves the next one too"""
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._indices: dict[Opcode, list[McapRecord]] = {
            kind: [] for kind in (Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX)
        }
        self._chunks: list[ChunkIndex] = []
        self._counts: dict[int, int] = {}
        stream.write(MAGIC)
        self._put(Header(profile=profile, library="drawbar"))

    def add_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Describe messages; return the schema's number."""
        self._schemas.append(Schema(id=len(self._schemas) + 1, name=name, encoding=encoding, data=data))
        self._put(self._schemas[-1])
        return len(self._schemas)

    def add_channel(self, topic: str, encoding: str, schema: int) -> int:
        """Open a channel; return its number."""
        number = len(self._channels) + 1
        self._channels.append(Channel(id=number, topic=topic, message_encoding=encoding, metadata={}, schema_id=schema))
        self._put(self._channels[-1])
        self._counts[number] = 0
        return number

    def add_attachment(self, name: str, media_type: str, data: bytes, *, created: int) -> None:
        """Put a file into the file; `created` in ns since 1970."""
        about = {"log_time": 0, "create_time": created, "name": name, "media_type": media_type}
        offset, length = self._put(Attachment(data=data, **about))  # type: ignore[arg-type]
        index = AttachmentIndex(offset=offset, length=length, data_size=len(data), **about)  # type: ignore[arg-type]
        self._indices[Opcode.ATTACHMENT_INDEX].append(index)

    def add_metadata(self, name: str, data: Mapping[str, str]) -> None:
        """Put named texts into the file."""
        offset, length = self._put(Metadata(name=name, metadata=dict(data)))
        self._indices[Opcode.METADATA_INDEX].append(MetadataIndex(offset=offset, length=length, name=name))

    def add_message(self, channel: int, data: bytes, *, sequence: int, log_time: int, publish_time: int) -> None:
        """Append a message; it may stay in memory until flush(). Times in ns."""
        self.add_messages(channel, [(data, sequence, log_time, publish_time)])

    def add_messages(self, channel: int, messages: Sequence[Message], *, before: bytes = b"") -> None:
        """Append messages, the same bytes before the data of each; they may stay in memory until flush()."""
        while messages:
            if self._chunk is None:
                self._chunk = _Chunk(self._stream, self._compressor, self._records)
            messages = messages[self._chunk.add(channel, messages, before) :]
            if self._chunk.size >= CHUNK_BYTES:
                self._end_chunk()

    def flush(self) -> None:
        """Let all that was added reach the operating system."""
        if self._chunk is None:
            return
        if self._compressor and not self._chunk.is_begun and self._chunk.size >= CHUNK_BYTES // _WORTH:
            self._end_chunk()
        else:
            self._chunk.flush()

    def finish(self) -> None:
        """Write what remains of the last chunk, and the summary."""
        self._put(DataEnd(data_section_crc=0))
        start = self._stream.tell()
        builder, offsets = RecordBuilder(), []
        for kind, records in self._summary().items():
            first = builder.count
            for record in records:
                record.write(builder)
            if records:
                offsets.append(
                    SummaryOffset(group_opcode=kind, group_start=start + first, group_length=builder.count - first)
                )
        offsets_start = start + builder.count
        for offset in offsets:
            offset.write(builder)
        summary = _bytes(builder)
        foot = struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offsets_start)
        self._stream.write(summary)
        self._put(
            Footer(
                summary_start=start,
                summary_offset_start=offsets_start,
                summary_crc=zlib.crc32(foot, zlib.crc32(summary)),
            )
        )
        self._stream.write(MAGIC)
        self._stream.flush()

    def _summary(self) -> dict[Opcode, list[McapRecord]]:
        statistics = Statistics(
            attachment_count=len(self._indices[Opcode.ATTACHMENT_INDEX]),
            channel_count=len(self._channels),
            channel_message_counts=self._counts,
            chunk_count=len(self._chunks),
            message_count=sum(self._counts.values()),
            metadata_count=len(self._indices[Opcode.METADATA_INDEX]),
            message_start_time=min((each.message_start_time for each in self._chunks), default=0),
            message_end_time=max((each.message_end_time for each in self._chunks), default=0),
            schema_count=len(self._schemas),
        )
        return {
            Opcode.SCHEMA: [*self._schemas],
            Opcode.CHANNEL: [*self._channels],
            Opcode.STATISTICS: [statistics],
            Opcode.CHUNK_INDEX: [*self._chunks],
            **self._indices,
        }

    def _end_chunk(self) -> None:
        if self._chunk is not None:
            self._chunks.append(self._chunk.end())
            for channel, count in self._chunk.counts().items():
                self._counts[channel] += count
            self._chunk = None

    def _put(self, record: McapRecord) -> tuple[int, int]:
        """Write a record outside of chunks; return its offset and length."""
        self._end_chunk()
        offset, builder = self._stream.tell(), RecordBuilder()
        record.write(builder)
        length = builder.count
        self._stream.write(_bytes(builder))
        self._stream.flush()
        return offset, length


def _bytes(builder: RecordBuilder) -> bytes:
    return bytes(builder.end())  # type: ignore[no-untyped-call]  # mcap left its annotation out


def _compressor(level: int) -> zstandard.ZstdCompressor:
    parameters = zstandard.ZstdCompressionParameters.from_level(level, window_log=_WINDOW_LOG, write_checksum=True)
    return zstandard.ZstdCompressor(compression_params=parameters)


def _message_index(channel: int, entries: list[int]) -> bytes:
    """Return the record that says where messages lie: the time of each and its place, in turn."""
    size = 8 * len(entries)
    return struct.pack(f"<BQHI{len(entries)}Q", Opcode.MESSAGE_INDEX, 6 + size, channel, size, *entries)


class _Chunk:
    """The chunk that grows."""

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
            pieces += _MESSAGE.pack(_MESSAGE_CODE, length, channel, sequence, log_time, publish_time), before, data
            places += log_time, size
            size += FRAME.size + length
            if size >= CHUNK_BYTES:
                break
        self._records.writelines(pieces)
        self.size = size
        return len(pieces) // 3

    @property
    def is_begun(self) -> bool:
        """Whether some records are in the file."""
        return self._written > 0

    def flush(self) -> None:
        """Write what waits as it is."""
        if not self.is_begun:
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
        """Make it complete, the messages' index behind it; return what the summary says of the chunk."""
        times = [entries[::2] for entries in self._messages.values()]
        span = min(map(min, times)), max(map(max, times))
        start, compressed = self._compress(self._compressor, span) if self._compressor else self._close(span)
        behind = self._stream.seek(0, SEEK_END)
        indices, offsets = list[bytes](), {}
        for channel, entries in self._messages.items():
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
        """Say how long the chunk is; return where it begins, and the size of its records."""
        self.flush()
        head = _chunk_head(span, self.size, self._crc, "", self.size)
        _write(self._stream, self._start + FRAME.size, head[FRAME.size :])
        _write(self._stream, self._start, head[: FRAME.size])
        return self._start, self.size

    def _compress(self, compressor: zstandard.ZstdCompressor, span: tuple[int, int]) -> tuple[int, int]:
        """Write the chunk compressed; return where it begins, and the size of its records then."""
        with self._records.getbuffer() as records:
            content = compressor.compress(self._by_channel(records[: self.size]))
        head = _chunk_head(span, self.size, 0, COMPRESSION, len(content))  # the frame has a checksum
        if self.is_begun:
            self.flush()  # what takes its place is shorter then, and nothing stays void
            return _replace(self._stream, self._start, head + content), len(content)
        start = self._stream.tell()
        self._stream.writelines((head, content))
        return start, len(content)

    def _by_channel(self, records: memoryview) -> bytes | memoryview:
        """Return the records with those of a channel together, and note where each lies now."""
        if len(self._messages) == 1:
            return records
        together, place = list[memoryview](), 0
        for entries in self._messages.values():
            for i in range(1, len(entries), 2):
                begin, (_, length) = entries[i], FRAME.unpack_from(records, entries[i])
                together.append(records[begin : begin + FRAME.size + length])
                entries[i], place = place, place + FRAME.size + length
        return b"".join(together)


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
