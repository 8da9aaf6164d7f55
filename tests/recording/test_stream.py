"""Records are read one after the other, chunks unpacked ahead of them."""

import struct
from collections.abc import Iterator
from io import BytesIO
from itertools import pairwise
from threading import Event
from typing import Any

import pytest
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Chunk, MessageIndex

from drawbar.recording import chunk, stream
from drawbar.recording.chunk import CHUNK_HEAD, FRAME, LEVEL
from drawbar.recording.chunked_writer import MAGIC, ChunkedWriter
from drawbar.recording.stream import LoggedMessage, read_records

BOTH = pytest.mark.parametrize("level", [None, LEVEL])


def written(messages: int, size: int = 100, level: int | None = None) -> BytesIO:
    """Return a file of messages (bytes each) in chunks of one message."""
    file = BytesIO()
    writer = ChunkedWriter(file, level)
    channel = writer.add_channel("/step", "json", 0)
    for number in range(messages):
        writer.add_message(channel, bytes([number]) * size, sequence=number, log_time=number, publish_time=number)
    writer.finish()
    file.seek(0)
    return file


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chunk, "CHUNK_BYTES", 1)


@BOTH
def test_messages_come_in_their_order_with_topic_and_time(level: int | None) -> None:
    found = list(read_records(written(3, level=level)))
    assert found == [LoggedMessage("/step", number, number, bytes([number]) * 100, "") for number in range(3)]


def test_messages_of_a_channel_stand_together_and_the_index_finds_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chunk, "CHUNK_BYTES", 400)
    file = BytesIO()
    writer = ChunkedWriter(file, LEVEL)
    channels = [writer.add_channel(topic, "json", 0) for topic in ("/a", "/b")]
    sent = [(channels[i % 3 == 1], i, bytes([i]) * (i + 1)) for i in range(40)]
    for channel, number, data in sent:
        writer.add_message(channel, data, sequence=number, log_time=number, publish_time=number)
    writer.finish()
    file.seek(0)
    found = list(read_records(file))
    for topic, channel in zip(("/a", "/b"), channels, strict=True):
        mine = [(each.publish_time, each.data) for each in found if each.topic == topic]
        assert mine == [(number, data) for each, number, data in sent if each == channel]
    assert sum(a.topic != b.topic for a, b in pairwise(found)) < sum(a[0] != b[0] for a, b in pairwise(sent)) / 2
    assert sorted(indexed(file)) == [(number, channel) for channel, number, _ in sent]


def indexed(file: BytesIO) -> Iterator[tuple[int, int]]:
    """Yield time and channel of each message to which the indices of the file's chunks lead."""
    file.seek(0)
    summary = make_reader(file).get_summary()
    assert summary is not None
    for index in summary.chunk_indexes:
        data = zstandard.decompress(record(file, index.chunk_start_offset, Chunk).data)
        for channel, place in index.message_index_offsets.items():
            for time, offset in record(file, place, MessageIndex).records:
                code, _, of, _, stamp = struct.unpack_from("<BQHIQ", data, offset)
                assert (code, of, stamp) == (Opcode.MESSAGE, channel, time)
                yield time, channel


def record(file: BytesIO, place: int, kind: Any) -> Any:
    """Return a record that stands at a place."""
    file.seek(place + FRAME.size)
    return kind.read(ReadDataStream(file))


class InterruptedFrame:
    """The frame of a record, at whose fifth look the keyboard interrupts."""

    size = FRAME.size

    def __init__(self) -> None:
        self.looks = 0

    def unpack_from(self, records: bytes, place: int) -> tuple[Any, ...]:
        self.looks += 1
        if self.looks == 5:
            raise KeyboardInterrupt
        return FRAME.unpack_from(records, place)


def test_a_chunk_whose_end_is_interrupted_is_whole_when_it_is_ended_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chunk, "CHUNK_BYTES", 10_000)
    file = BytesIO()
    writer = ChunkedWriter(file, LEVEL)
    channels = [writer.add_channel(topic, "json", 0) for topic in ("/a", "/b")]
    sent = [(i % 2, i, bytes([i]) * (i + 1)) for i in range(20)]
    for channel, number, data in sent:
        writer.add_message(channels[channel], data, sequence=number, log_time=number, publish_time=number)
    monkeypatch.setattr(chunk, "FRAME", InterruptedFrame())
    with pytest.raises(KeyboardInterrupt) as interrupt:  # holds what the interrupted function held
        writer.finish()
    monkeypatch.setattr(chunk, "FRAME", FRAME)
    writer.finish()
    assert interrupt.value is not None
    file.seek(0)
    found = sorted((each.publish_time, each.data) for each in read_records(file))
    assert found == [(number, data) for _, number, data in sent]


@BOTH
def test_a_file_cut_at_any_byte_has_the_chunks_before_it(level: int | None) -> None:
    data = written(3, level=level).getvalue()
    whole = list(read_records(BytesIO(data)))
    counts = [len(list(read_records(BytesIO(data[:end])))) for end in range(len(MAGIC), len(data) + 1)]
    assert counts == sorted(counts)
    assert set(counts) == {0, 1, 2, 3}
    assert len(whole) == 3


def test_a_chunk_without_an_end_needs_no_more_memory_than_it_has_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    class Small(BytesIO):
        def read(self, size: int | None = -1, /) -> bytes:
            if size is None or not 0 <= size <= 1 << 26:
                raise MemoryError
            return super().read(size)

    monkeypatch.setattr(chunk, "CHUNK_BYTES", 1000)
    file = BytesIO()
    writer = ChunkedWriter(file)
    writer.add_message(writer.add_channel("/step", "json", 0), b"one", sequence=0, log_time=0, publish_time=0)
    writer.flush()
    assert list(read_records(Small(file.getvalue()))) == [LoggedMessage("/step", 0, 0, b"one", "")]


def test_the_next_chunk_is_unpacked_while_the_caller_works_on_one(monkeypatch: pytest.MonkeyPatch) -> None:
    unpacked, second = stream._unpacked, Event()
    calls = 0

    def watched(content: bytes, **options: Any) -> bytes:
        nonlocal calls
        calls += 1
        if calls == 2:
            second.set()
        return unpacked(content, **options)

    monkeypatch.setattr(stream, "_unpacked", watched)
    records = read_records(written(3))
    next(records)
    assert second.wait(120.0)
    assert len(list(records)) == 2


@BOTH
@pytest.mark.parametrize("size", [10, 200, 1 << 40])
def test_a_chunk_of_another_size_than_it_says_is_damaged(size: int, level: int | None) -> None:
    data = bytearray(written(2, level=level).getvalue())
    summary = make_reader(BytesIO(data)).get_summary()
    assert summary is not None
    at = summary.chunk_indexes[0].chunk_start_offset
    opcode, length, first, last, _, *rest = CHUNK_HEAD.unpack_from(data, at)
    CHUNK_HEAD.pack_into(data, at, opcode, length, first, last, size, *rest)
    damage, message = read_records(BytesIO(data))
    assert damage == (at, at + 9 + length)
    assert message == list(read_records(written(2)))[1]


class Watched(BytesIO):
    """A file of which each state is kept that a killed process may leave: after half a write, too."""

    def __init__(self) -> None:
        super().__init__()
        self.states = list[bytes]()

    def write(self, data) -> int:
        halves = (data[: len(data) // 2], data[len(data) // 2 :]) if len(data) > FRAME.size else (data,)
        for half in halves:
            super().write(half)
            self.states.append(self.getvalue())
        return len(data)

    def truncate(self, size: int | None = None) -> int:
        kept = super().truncate(size)
        self.states.append(self.getvalue())
        return kept


@BOTH
@pytest.mark.parametrize("bytes_each", [10, 3000])
def test_a_kill_at_any_moment_costs_one_message_at_most(
    monkeypatch: pytest.MonkeyPatch, bytes_each: int, level: int | None
) -> None:
    monkeypatch.setattr(chunk, "CHUNK_BYTES", 2 * bytes_each)  # those of 10 are longer when they are compressed
    file, told = Watched(), [bytes([65 + number]) * bytes_each for number in range(6)]
    writer = ChunkedWriter(file, level)
    channel = writer.add_channel("/test", "", 0)
    for number, data in enumerate(told):
        before = len(file.states)
        writer.add_message(channel, data, sequence=number, log_time=number, publish_time=number)
        writer.flush()
        found = [[record.data for record in read_records(BytesIO(state))] for state in file.states[before:]]
        assert all(each in (told[:number], told[: number + 1]) for each in found)
        assert found[-1] == told[: number + 1]
    writer.finish()
    assert [record.data for record in read_records(BytesIO(file.getvalue()))] == told
