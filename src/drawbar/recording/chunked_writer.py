"""Chunked writer of an MCAP file (https://mcap.dev/spec): records, messages in chunks (chunk.py), and the summary."""

import struct
import zlib
from collections.abc import Mapping, Sequence
from io import BytesIO
from typing import BinaryIO

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

from drawbar.recording.chunk import Chunk, Message, compressor_of

MAGIC = b"\x89MCAP0\r\n"


class ChunkedWriter:
    """Puts records into a seekable stream that is at its beginning; the caller opens and closes it."""

    def __init__(self, stream: BinaryIO, level: int | None = None) -> None:
        """Write the magic and the header.

        Args:
            stream: to be written.
            level: zstd's, of the chunks; None: they stay as they are.
        """
        self._stream = stream
        self._compressor = None if level is None else compressor_of(level)
        self._chunk: Chunk | None = None
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
        self._put(Header(profile="drawbar", library="drawbar"))

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
                self._chunk = Chunk(self._stream, self._compressor, self._records)
            messages = messages[self._chunk.add(channel, messages, before) :]
            if self._chunk.is_full:
                self._end_chunk()

    def flush(self) -> None:
        """Let all that was added reach the operating system."""
        if self._chunk is None:
            return
        if self._chunk.is_worth_compressing:
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
