"""Columns of a long log: read without the steps' objects and without what is not asked for.

What stands beside its chunks (blocks.py) is taken as it is; the steps of chunks that have nothing beside them, such as
the last one of a log that a crash cut off, are parsed as far as the columns need it.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import chain, islice
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np

from drawbar.errors import DrawbarError
from drawbar.geometry import Floats
from drawbar.recording.blocks import Block, decode_block, reported
from drawbar.recording.log import Outcome, RunHeader, open_log
from drawbar.recording.stream import LoggedMessage, records_beside_chunks

_BLOCK = 1000
"""steps that are Python objects at the same time"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ColumnLog:
    """The numbers of a log that were asked for: n steps."""

    header: RunHeader
    outcome: Outcome
    has_truth: bool
    names: tuple[str, ...]
    """of the columns"""
    blocks: list[Block]
    """one after the other"""

    @property
    def steps(self) -> int:
        """How many."""
        return sum(len(block.wall_time) for block in self.blocks)

    @property
    def wall_time(self) -> Floats:
        """(n,): s since 1970."""
        return np.concatenate([np.empty(0), *(block.wall_time for block in self.blocks)])

    def column(self, name: str) -> Floats:
        """Return one number of every step, (n,); see RunLog.column. Raises ValueError for one not asked for."""
        if name.startswith("truth.") and not self.has_truth:
            return np.full(self.steps, np.nan)
        place = self.names.index(name)
        parts = (np.broadcast_to(block.columns[place], block.wall_time.shape) for block in self.blocks)
        return np.concatenate([np.empty(0), *parts], dtype=np.float64)


class _Beside(NamedTuple):
    """What stands beside the first chunks of a log."""

    has_truth: bool | None
    """None: there is nothing"""
    blocks: list[Block]
    end: int
    """byte of the file from which on steps are still to be parsed"""


def read_columns(file: Path, names: Sequence[str] | None = None) -> ColumnLog:
    """Read columns of a log in a stream, by default those of its report; errors as read_log."""
    beside = _beside(file, names)
    with open_log(file, beside.end) as log:
        first = list(islice(log.steps, 1))
        has_truth = beside.has_truth
        if has_truth is None:
            has_truth = bool(first) and b'"truth":null' not in first[0].data
        known = _known(names, has_truth)
        blocks = [*beside.blocks, *_parsed(chain(first, log.steps), known)]
        return ColumnLog(header=log.header, outcome=log.outcome(), has_truth=has_truth, names=known, blocks=blocks)


def _known(names: Sequence[str] | None, has_truth: bool) -> tuple[str, ...]:
    """Return which of the columns that are asked for a log has."""
    wanted = reported(has_truth=has_truth) if names is None else names
    return tuple(name for name in wanted if has_truth or not name.startswith("truth."))


def _beside(file: Path, names: Sequence[str] | None) -> _Beside:
    """Read what stands beside the chunks of a log, up to the first one that lacks a column which is asked for."""
    has_truth, blocks, end = None, list[Block](), 0
    with suppress(OSError), file.open("rb") as stream:  # what is wrong with the file shows when the rest is read
        for place, content in records_beside_chunks(stream):
            if (decoded := decode_block(content)) is None:
                break
            given, block = decoded
            if block.wall_time.size:
                has_truth = any(name.startswith("truth.") for name in given) if has_truth is None else has_truth
                known = _known(names, has_truth)
                if not set(known) <= set(given):
                    break
                blocks.append(Block(block.wall_time, [block.columns[given.index(name)] for name in known]))
            end = place
    return _Beside(has_truth if blocks else None, blocks, end)


def _parsed(steps: Iterator[LoggedMessage], names: tuple[str, ...]) -> Iterator[Block]:
    decode, pick = _reader(names)
    while True:
        times, rows = list[float](), list[Any]()
        try:
            for message in islice(steps, _BLOCK):
                times.append(message.publish_time * 1e-9)
                rows.append(pick(decode(message.data)))
        except msgspec.ValidationError as error:
            raise DrawbarError(f"a step lacks what every step of drawbar has ({error})") from error
        if not rows:
            return
        yield Block.of(times, rows, names)


@cache
def _reader(names: tuple[str, ...]) -> tuple[Callable[[bytes], Any], Callable[[Any], tuple[Any, ...]]]:
    """Return what decodes a step as far as some numbers need it, and what picks them."""
    tree: dict[str, Any] = {}
    for name in names:
        place = tree
        *sections, last = name.split(".")
        for section in sections:
            place = place.setdefault(section, {})
        place[last] = None
    safe = (".".join(f"_{part}" if part.isdigit() else part for part in name.split(".")) for name in names)
    return msgspec.json.Decoder(_struct("Step", tree)).decode, attrgetter(*safe)


def _struct(name: str, tree: Mapping[str, Any]) -> Any:
    """Return the type of a section of which some numbers are wanted; of an array up to the last one wanted."""
    if all(key.isdigit() for key in tree):
        fields = [(f"_{index}", float | None) for index in range(1 + max(map(int, tree)))]
        return msgspec.defstruct(name, fields, array_like=True, gc=False)
    members = [(key, bool | float | None if below is None else _struct(key, below)) for key, below in tree.items()]
    return msgspec.defstruct(name, members, gc=False)
