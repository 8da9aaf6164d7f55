"""A long log as columns: read in a stream, without the steps' objects and without what is not asked for.

Positions, times and progress are kept as they are, all else in single precision, and a number that stays the same for
some time once. What takes long is to parse the steps, which holds the interpreter's lock: half of a long log is read
in a process of its own (columns_main.py).
"""

import pickle
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache, partial
from itertools import chain, islice
from operator import attrgetter
from pathlib import Path
from subprocess import DEVNULL, Popen
from tempfile import TemporaryFile
from typing import IO, Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from drawbar.errors import DrawbarError
from drawbar.geometry import Floats
from drawbar.recording.log import STEP_TOPIC, Outcome, RunHeader, open_log, reading
from drawbar.recording.stream import WHOLE, LoggedMessage

_BLOCK = 1000
"""steps that are Python objects at the same time"""
_LONG = 100_000_000
"""bytes of a log from which on a second process takes less time than it saves"""
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
_WIDE = (".x", ".y", "_x", "_y", ".time", ".progress")
"""how names of numbers end that single precision would spoil"""


class Block(NamedTuple):
    """Numbers of m steps that follow each other."""

    wall_time: Floats
    """(m,): s since 1970"""
    columns: list[NDArray[np.float32] | NDArray[np.float64]]
    """(m,) each, or (1,) of a number that stays the same"""


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


def reported(*, has_truth: bool) -> tuple[str, ...]:
    """Return what the report of a run is made of, whose truth is known or not."""
    return (*_REPORTED, *(_REPORTED_OF_TRUTH if has_truth else _REPORTED_WITHOUT_TRUTH))


def read_columns(file: Path, names: Sequence[str] | None = None) -> ColumnLog:
    """Read columns of a log in a stream, by default those of its report; errors as read_log."""
    near, far = _halves(file)
    with open_log(file, near) as log:
        first = list(islice(log.steps, 1))
        has_truth = bool(first) and b'"truth":null' not in first[0].data
        wanted = reported(has_truth=has_truth) if names is None else names
        known = tuple(name for name in wanted if has_truth or not name.startswith("truth."))
        with _read_beside(file, far, known) as rest:
            blocks = [*_blocks(chain(first, log.steps), known), *rest()]
        return ColumnLog(header=log.header, outcome=log.outcome(), has_truth=has_truth, names=known, blocks=blocks)


def read_blocks(file: Path, within: range, names: tuple[str, ...]) -> Iterator[Block]:
    """Yield columns of the steps that lie in some bytes of a log; errors as read_log."""
    with reading(file, within) as records:
        steps = (each for each in records if isinstance(each, LoggedMessage) and each.topic == STEP_TOPIC)
        yield from _blocks(steps, names)


def _halves(file: Path) -> tuple[range, range]:
    """Return which bytes of a log are read here, and which in a process of its own: none of a short one."""
    size = file.stat().st_size if file.is_file() else 0
    middle = size // 2 if size > _LONG else WHOLE.stop
    return range(middle), range(middle, WHOLE.stop)


@contextmanager
def _read_beside(file: Path, within: range, names: tuple[str, ...]) -> Iterator[Callable[[], list[Block]]]:
    """Read blocks in a process of its own while the caller does something else, who then asks for them."""
    if not within:
        yield list
        return
    command = [sys.executable, "-P", "-m", "drawbar.recording.columns_main", str(file), str(within.start), *names]
    with TemporaryFile() as sent, Popen(command, stdin=DEVNULL, stdout=sent, stderr=DEVNULL) as process:
        try:
            yield lambda: _sent_by(process, sent) or list(read_blocks(file, within, names))  # it failed: why shows here
        finally:
            process.kill()


def _sent_by(process: Popen[bytes], sent: IO[bytes]) -> list[Block]:
    """Return the blocks that another process writes into a file, when it has ended; none if it failed."""
    process.wait()
    sent.seek(0)
    with suppress(EOFError, pickle.UnpicklingError):
        return list(iter(partial(pickle.load, sent), None))
    return []


def _blocks(steps: Iterator[LoggedMessage], names: tuple[str, ...]) -> Iterator[Block]:
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
        yield Block(np.array(times), list(_kept(np.array(rows, dtype=np.float64), names)))


def _kept(table: Floats, names: tuple[str, ...]) -> Iterator[NDArray[np.float32] | NDArray[np.float64]]:
    """Yield the columns of a table (m, names), as they are kept in a Block."""
    stays = (table == table[0]).all(axis=0) | np.isnan(table).all(axis=0)
    for name, values, alike in zip(names, table.T, stays.tolist(), strict=True):
        kind = np.float64 if name.endswith(_WIDE) else np.float32
        yield values[: 1 if alike else None].astype(kind)


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
