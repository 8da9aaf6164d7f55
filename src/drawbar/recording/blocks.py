"""Blocks: numbers of many steps as columns, which a report is made of and a log keeps beside each of its chunks.

JSON is what every program reads, and none reads fast. So behind each chunk of a log stands a record with the columns of
the steps in that chunk, for the report alone; other programs pass over it. Positions, times and progress are kept as
they are, all else in single precision, and a number that stays the same for some time once.
"""

import struct
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from operator import attrgetter
from typing import Any, NamedTuple

import msgspec
import numpy as np
import zstandard
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.signals import StepRecord

_SLIPS = ("longitudinal_slip", "tractor_slip", "steering_offset", "tractor_crab", "trailer_crab")
_STEERINGS = ("tractor_steering", "trailer_steering")
_BODIES = ("tractor", "trailer")
_REPORTED: tuple[str, ...] = (
    *(f"measurement.{name}" for name in ("time", "tractor_x", "tractor_y", "speed", "hitch_angle")),
    *(f"measurement.{body}_roll" for body in _BODIES),
    *(f"estimate.{body}.yaw" for body in _BODIES),
    *(f"estimate.{name}" for name in ("speed", "hitch_angle", "trailer_slip", *_SLIPS)),
    *(f"estimate.{body}_fix" for body in _BODIES),
    *(f"reference.{body}.{name}" for body in _BODIES for name in ("progress", "lateral_error", "closest.2")),
    *(f"{body}_steering.{name}" for body in _BODIES for name in ("command", "ancillary", "saturated", "margin")),
    "command.speed",
    *(f"{each}_times.{phase}" for each in ("estimator", *_BODIES) for phase in ("prepare", "feedback")),
    "solver_failures",
    "gate",
)
_REPORTED_OF_TRUTH: tuple[str, ...] = (
    *(f"truth.{body}.{name}" for body in _BODIES for name in ("x", "y", "yaw")),
    *(f"truth.{name}" for name in (*_SLIPS, *_STEERINGS)),
    *(f"truth.{body}_{angle}" for body in _BODIES for angle in ("roll", "pitch")),
)
_REPORTED_WITHOUT_TRUTH: tuple[str, ...] = (
    *(f"estimate.{body}.{name}" for body in _BODIES for name in "xy"),
    "estimate.tractor_steering",
    *(f"measurement.{name}" for name in _STEERINGS),
    "flags",
)
"""in place of what nobody knows"""
WIDE = (".x", ".y", "_x", "_y", ".time", ".progress")
"""how names of numbers end that single precision would spoil"""
_COMPRESSOR = zstandard.ZstdCompressor(level=1, write_checksum=True)

Column = NDArray[np.float32] | NDArray[np.float64]


class Block(NamedTuple):
    """Numbers of m steps that follow each other."""

    wall_time: Floats
    """(m,): s since 1970"""
    columns: list[Column]
    """(m,) each, or (1,) of a number that stays the same"""

    @classmethod
    def of(cls, times: Sequence[float], rows: Sequence[Sequence[Any]] | Floats, names: Sequence[str]) -> "Block":
        """Return the rows (m, names) of m steps; None, and what JSON cannot hold, is missing: NaN."""
        table = np.array(rows, dtype=np.float64).reshape(len(times), len(names))
        table[~np.isfinite(table)] = np.nan
        with np.errstate(over="ignore"):
            return cls(np.array(times), list(_columns(table, names)))


def _columns(table: Floats, names: Sequence[str]) -> Iterator[Column]:
    stays = (table == table[:1]).all(axis=0) | np.isnan(table).all(axis=0)
    for name, values, alike in zip(names, table.T, stays.tolist(), strict=True):
        yield values[: 1 if alike else None].astype(_kind(name))


def _kind(name: str) -> str:
    return "<f8" if name.endswith(WIDE) else "<f4"


def reported(*, has_truth: bool) -> tuple[str, ...]:
    """Return what the report of a run is made of, whose truth is known or not."""
    return (*_REPORTED, *(_REPORTED_OF_TRUTH if has_truth else _REPORTED_WITHOUT_TRUTH))


class StepColumns:
    """Gathers the numbers of steps that are written to a log, until their chunk ends."""

    def __init__(self) -> None:
        """Begin without steps."""
        self._steps = list[tuple[float, bool, bytes]]()

    def add(self, record: StepRecord, wall_time: int) -> None:
        """Add a step, and when it is written, ns since 1970."""
        has_truth = record.truth is not None
        self._steps.append((wall_time * 1e-9, has_truth, _packer(has_truth)(record)))

    def take(self) -> bytes:
        """Return the steps since the last time for `decode_block`; nothing for none, and where some have no truth."""
        steps, self._steps = self._steps, []
        truths = {has_truth for _, has_truth, _ in steps}
        if len(truths) != 1:
            return b""
        names = reported(has_truth=truths.pop())
        rows = np.frombuffer(b"".join(row for _, _, row in steps)).reshape(len(steps), len(names))
        block = Block.of([time for time, _, _ in steps], rows, names)
        content = (names, block.wall_time.tobytes(), [column.tobytes() for column in block.columns])
        return _COMPRESSOR.compress(msgspec.msgpack.encode(content))


def decode_block(content: bytes) -> tuple[tuple[str, ...], Block] | None:
    """Return the names of the columns, and these; None where the content is damaged."""
    try:
        plain = zstandard.ZstdDecompressor().decompress(content)
        names, times, columns = msgspec.msgpack.decode(plain, type=tuple[tuple[str, ...], bytes, list[bytes]])
        kept = [np.frombuffer(column, _kind(name)) for name, column in zip(names, columns, strict=True)]
    except (zstandard.ZstdError, msgspec.MsgspecError, ValueError):
        return None
    return names, Block(np.frombuffer(times, "<f8"), kept)


@cache
def _packer(has_truth: bool) -> Callable[[StepRecord], bytes]:
    """Return what packs the reported numbers of a step."""
    parts = [(name, *name.rpartition(".")[::2]) for name in reported(has_truth=has_truth)]
    of_arrays = [(place, int(last)) for place, (_, _, last) in enumerate(parts) if last.isdigit()]
    values = attrgetter(*(head if last.isdigit() else name for name, head, last in parts))
    numbers = struct.Struct(f"={len(parts)}d")

    def pack(record: StepRecord) -> bytes:
        row = list(values(record))
        for place, index in of_arrays:
            row[place] = row[place][index]
        return numbers.pack(*row)

    return pack
