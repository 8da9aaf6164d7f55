"""Recorder of every control step, in a log that survives a crash: MCAP, chunks that are readable while they grow.

A step is written as the bytes that C made of it, behind the four that mark them as CDR.
"""

import math
import os
import time
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

import msgspec

from drawbar.errors import StorageError, demand, demand_path
from drawbar.file_lock import is_locked
from drawbar.recording.chunked_writer import ChunkedWriter
from drawbar.recording.encoding import encode_special
from drawbar.recording.log import HEADER_NAME, OUTCOME_NAME, STEP_TOPIC, Outcome, RunHeader
from drawbar.signals import StepRecord
from drawbar.step.layout import HEAD, packed, step_schema

_LATEST = 2**64 - 1
"""the last time that MCAP can hold, ns"""
STEP_NAME, DEFINITION, CDR = "drawbar/msg/StepRecord", "ros2msg", "cdr"
"""name of a step's schema, how that is written, and how a step is"""
_HELD_BACK = 20_000_000
"""how long a step may wait before it reaches the operating system, ns; adding those of a fast simulation in a go is
quicker than one by one between other work"""


def demand_not_recorded(file: Path) -> None:
    """Raise StorageError where another run records into a file."""
    with suppress(FileNotFoundError), file.open("rb") as stream:
        _take(stream, file)


def _take(stream: BinaryIO, file: Path) -> None:
    """Lock a file until it is closed, so that one run at a time records into it.

    Raises:
        StorageError: another run records into it.
    """
    if is_locked(stream):
        raise StorageError(f"{file}: another run is recorded there; wait until it has ended, or choose another folder")


def _untruncated(name: str, flags: int) -> int:
    """Open a file as it is: what another run has recorded stays until the file is this run's."""
    return os.open(name, flags & ~os.O_TRUNC, 0o666)


class Recorder:
    """The log of one run as a context: open at construction, complete with its outcome on leaving.

    A step that comes 20 ms after the one before, or later, reaches the operating system before `write` returns; where
    steps come faster, as in simulation, those of the last 20 ms may wait. A killed process leaves a log that is
    readable up to there. An exception that leaves the context becomes the outcome and travels on; leaving without one
    means that the run drove its path to the end.
    """

    def __init__(self, file: str | os.PathLike[str], header: RunHeader, *, level: int | None = None) -> None:
        """Create the file and write what is known before the first step.

        Args:
            file: to be written.
            header: of the run.
            level: zstd's, of the compression; None: there is none.

        Raises:
            StorageError: the file cannot be created, or another run is recorded there.
            DrawbarError: an argument is none.
        """
        self._file, self._steps, self._kept = demand_path("file", file), 0, 0
        self._time, self._flushed = 0, 0
        self._zero: float | None = None
        self._channel = 0
        """of the steps; 0: not opened yet"""
        self._waiting: list[tuple[bytes, int, float, int]] = []
        """steps that are not handed over: their bytes, numbers, times (s) and when they came (ns since 1970)"""
        demand("header", header, RunHeader, "give that of Simulation.header() or run_header()")
        try:
            self._stream = open(self._file, "wb", opener=_untruncated)  # noqa: SIM115 - it stays open
            try:
                _take(self._stream, self._file)
                if os.fstat(self._stream.fileno()).st_size:  # a device has no length
                    self._stream.truncate()
                self._begin(header, level)
            except (OSError, StorageError):
                self.give_up()
                raise
        except OSError as error:
            raise StorageError(f"{file}: cannot be written ({error.strerror}); choose another folder") from error

    def _begin(self, header: RunHeader, level: int | None) -> None:
        self._writer = ChunkedWriter(self._stream, level)
        data = msgspec.json.encode(header, enc_hook=encode_special)
        self._writer.add_attachment(HEADER_NAME, "application/json", data, created=time.time_ns())

    def write(self, record: StepRecord) -> None:
        """Append one step; its time is that of its measurement, counted from the first one where that is negative.

        Raises:
            StorageError: it cannot be written; what was flushed before is.
            SignalError: the record holds what is no number.
        """
        data, now = packed(record), time.time_ns()
        self._waiting.append((data, record.step, record.measurement.time, now))
        try:
            if not self._channel:
                self._channel = self._open_steps(len(record.plan.tractor.steerings))
            if abs(now - self._flushed) >= _HELD_BACK:
                self._hand_over()
                self._writer.flush()
                self._flushed, self._kept = now, self._steps
        except OSError as error:
            raise self._full(error) from error

    def _hand_over(self) -> None:
        """Give the writer the steps that wait."""
        waiting, self._waiting = self._waiting, []
        messages = [(data, step, self._log_time(seconds), wall) for data, step, seconds, wall in waiting]
        self._writer.add_messages(self._channel, messages, before=HEAD)
        self._steps += len(waiting)

    def _open_steps(self, stages: int) -> int:
        """Open the channel of the steps, whose plans have so many stages; return its number."""
        schema = self._writer.add_schema(STEP_NAME, DEFINITION, step_schema(stages).encode())
        return self._writer.add_channel(STEP_TOPIC, CDR, schema)

    def _log_time(self, seconds: float) -> int:
        """Return a time as MCAP holds it, ns from zero on; the last one again where a clock gives none."""
        if math.isfinite(seconds):
            if self._zero is None:
                self._zero = min(seconds, 0.0)
            passed = round((seconds - self._zero) * 1e9)
            self._time = passed if 0 <= passed <= _LATEST else min(max(passed, 0), _LATEST)
        return self._time

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if isinstance(error, StorageError) or self._stream.closed:
            self.give_up()
            return
        try:
            self._finish(self._outcome(error))
        except OSError as full:
            self.give_up()
            raise self._full(full) from full

    def _outcome(self, error: BaseException | None) -> Outcome:
        return Outcome.of(error)

    def _full(self, error: OSError) -> StorageError:
        return StorageError(
            f"{self._file}: the log cannot be written any further ({error.strerror}); its first {self._kept} "
            f"steps or more are kept: free space, then `drawbar report {self._file.parent}`"
        )

    def give_up(self) -> None:
        """Close the file, to which nothing can be added; what is left in the buffer has no place on the disk."""
        with suppress(OSError):
            self._stream.close()

    def _finish(self, outcome: Outcome) -> None:
        with self._stream:
            self._hand_over()
            finished = "true" if outcome.finished else "false"
            self._writer.add_metadata(OUTCOME_NAME, {"finished": finished, "reason": outcome.reason})
            self._writer.finish()
