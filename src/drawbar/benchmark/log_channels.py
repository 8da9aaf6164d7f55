"""Log channels: what each channel of a drive's log takes, `python -m drawbar.benchmark.log_channels RUN`.

The log's messages are put into chunks and compressed once more: of each channel alone, all together as drives do it,
and all together in other ways.
"""

import struct
from argparse import ArgumentParser
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path

from drawbar.recording.chunk import CHUNK_BYTES, compressor_of
from drawbar.recording.drive_log import REAL_TIME_LEVEL
from drawbar.recording.log import log_of
from drawbar.recording.stream import LoggedMessage, read_records

_HEAD = struct.Struct("<BQHIQQ")
_INDEX = 16
"""bytes of the index, of each message"""
_Record = tuple[str, bytes]
"""topic, and the message as it lies in a chunk"""


def _messages(file: Path) -> list[LoggedMessage]:
    with file.open("rb") as stream:
        found = [each for each in read_records(stream) if isinstance(each, LoggedMessage)]
    return sorted(found, key=lambda message: message.publish_time)


def _records(messages: Iterable[LoggedMessage]) -> Iterator[_Record]:
    numbers: dict[str, int] = {}
    for each in messages:
        number, time = numbers.setdefault(each.topic, len(numbers)), each.publish_time
        yield each.topic, _HEAD.pack(5, 22 + len(each.data), number, each.sequence, time, time) + each.data


def _chunks(records: Iterable[_Record]) -> Iterator[list[_Record]]:
    chunk, size = list[_Record](), 0
    for record in records:
        chunk.append(record)
        size += len(record[1])
        if size >= CHUNK_BYTES:
            yield chunk
            chunk, size = [], 0
    yield chunk


def _by_channel(chunk: Iterable[_Record]) -> dict[str, bytes]:
    found = defaultdict[str, list[bytes]](list)
    for topic, record in chunk:
        found[topic].append(record)
    return {topic: b"".join(records) for topic, records in found.items()}


def main() -> None:
    """Print the figures."""
    parser = ArgumentParser(prog="python -m drawbar.benchmark.log_channels")
    parser.add_argument("run", type=Path, help="folder of a drive, or its log")
    messages = _messages(log_of(parser.parse_args().run))
    hourly = 3600e3 / (messages[-1].publish_time - messages[0].publish_time)  # MB/h per byte
    counts, plain, packed = (defaultdict[str, int](int) for _ in range(3))
    ways = {"as it is": 0, "at level 1": 0, "in the order of time": 0}
    usual, quick = compressor_of(REAL_TIME_LEVEL), compressor_of(1)
    for chunk in _chunks(_records(messages)):
        channels = _by_channel(chunk)
        for topic, records in channels.items():
            counts[topic] += sum(each == topic for each, _ in chunk)
            plain[topic] += len(records)
            packed[topic] += len(usual.compress(records))
        together = b"".join(channels.values())
        ways["as it is"] += len(usual.compress(together))
        ways["at level 1"] += len(quick.compress(together))
        ways["in the order of time"] += len(usual.compress(b"".join(record for _, record in chunk)))
    print(f"{'':14} {'messages':>8} {'bytes':>7} {'packed':>7} {'MB/h':>6} {'index':>6}")
    for topic in sorted(packed, key=packed.__getitem__, reverse=True):
        count = counts[topic]
        sizes = f"{plain[topic] / count:7.0f} {packed[topic] / count:7.1f}"
        print(f"{topic:14} {count:8} {sizes} {packed[topic] * hourly:6.2f} {_INDEX * count * hourly:6.2f}")
    index = _INDEX * len(messages) * hourly
    for way, size in ways.items():
        print(f"all {way}: {size * hourly:.1f} MB/h, with the index {size * hourly + index:.1f}")


if __name__ == "__main__":
    main()
