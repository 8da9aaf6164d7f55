"""Log of a run: what it holds and how it is read back, as a whole or after a crash.

A log is an MCAP file (https://mcap.dev/spec): an attachment `run.json` with the RunHeader, one message per StepRecord
on the topic `/step`, in chunks, and at the end, in most cases, the metadata `outcome`. The steps are CDR, as
step/layout.py describes it. Those of older logs are JSON, with null for NaN and infinity; they are read as before.
"""

import os
import stat
import struct
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Protocol, Self

import msgspec
import numpy as np
from mcap.exceptions import McapError
from mcap.records import Attachment, Metadata
from pydantic import ValidationError

from drawbar.errors import DrawbarError, demand, demand_path
from drawbar.geometry import Floats
from drawbar.recording.encoding import decode_special, decode_step
from drawbar.recording.frames import Damage, DamagedLogError
from drawbar.recording.losses import Losses
from drawbar.recording.named_numbers import no_number, number_of
from drawbar.recording.path_table import PathTable, RecordedPoints
from drawbar.recording.stream import Logged, LoggedMessage, read_records
from drawbar.signals import StepRecord
from drawbar.vehicle.parameters import VehicleParameters

LOG_NAME = "log.mcap"
"""of a run's log in its folder"""
HEADER_NAME = "run.json"
OUTCOME_NAME = "outcome"
STEP_TOPIC = "/step"
_DAMAGE = (
    McapError,
    msgspec.MsgspecError,
    ValidationError,
    ValueError,
    KeyError,
    struct.error,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RunHeader:
    """What is known before the first step; makes a log readable without the files it came from."""

    configuration_name: str
    configuration: str
    """the complete resolved configuration, TOML"""
    seed: int
    started: datetime
    vehicle: VehicleParameters
    path_name: str
    path_note: str
    """how a recorded line was made drivable; empty for other paths"""
    path: PathTable
    recorded: RecordedPoints | None
    """None where the path was not made from a recorded line"""
    origin: tuple[float, float, float] | None = None
    """where the path's frame begins on WGS84: latitude, longitude (degrees), height (m); None: not known"""
    estimate_bounds: Mapping[str, tuple[float, float]]
    """lower and upper bound of the estimator by field name of Estimate, SI"""
    shadow: bool = False
    """drawbar only looked on, while the driver steered"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """How a run ended."""

    finished: bool
    reason: str

    @classmethod
    def of(cls, error: BaseException | None) -> Self:
        """Return what ended a run; only an error that no user was meant to read shows the name of its class."""
        if error is None:
            return cls(finished=True, reason="the path was driven to its end")
        if isinstance(error, KeyboardInterrupt):
            return cls(finished=False, reason="interrupted at the keyboard")
        reason = str(error) if isinstance(error, DrawbarError) else f"{type(error).__name__}: {error}"
        return cls(finished=False, reason=reason)


CUT_OFF = Outcome(
    finished=False,
    reason="the log just stops: the program was killed or still runs, or the file is not complete",
)
"""of a log that holds none"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunLog:
    """A log read back: n steps."""

    header: RunHeader
    records: tuple[StepRecord, ...]
    wall_time: Floats
    """(n,): time of the computer's clock at which each step was written, s since 1970"""
    outcome: Outcome
    losses: tuple[str, ...] = ()
    """what of the file is damaged, and which steps are lost by that"""

    @property
    def shortcomings(self) -> tuple[str, ...]:
        """What it lacks: its losses, and, where it was cut off, its end."""
        return (*self.losses, self.outcome.reason) if self.outcome is CUT_OFF else self.losses

    @property
    def steps(self) -> int:
        """How many."""
        return len(self.records)

    @property
    def has_truth(self) -> bool:
        """Whether the machine was a simulated one."""
        return any(record.truth is not None for record in self.records)

    def column(self, name: str) -> Floats:
        """Return one number of every step, (n,); NaN where the step has no truth, or no plan whose deviation it is.

        The name is that of the field in StepRecord, as in `estimate.tractor.x`; of an array with the place in it, as in
        `plan.tractor.deviation.0`. Raises DrawbarError where there is no such number.
        """
        demand("name", name, str, "give one such as 'estimate.tractor.x'")
        value = number_of(name)
        of_truth = name.startswith("truth.")
        try:
            return np.array(
                [np.nan if of_truth and record.truth is None else value(record) for record in self.records],
                dtype=float,
            )
        except (AttributeError, TypeError):
            raise DrawbarError(no_number(name, self.records[0])) from None


class Columns(Protocol):
    """What a report needs of a log: a RunLog, or a ColumnLog of a long one."""

    @property
    def header(self) -> RunHeader:
        """What was known before the first step."""

    @property
    def wall_time(self) -> Floats:
        """(n,): s since 1970."""

    @property
    def outcome(self) -> Outcome:
        """How the run ended."""

    @property
    def losses(self) -> tuple[str, ...]:
        """What of the file is damaged, and which steps are lost by that."""

    @property
    def steps(self) -> int:
        """How many."""

    @property
    def has_truth(self) -> bool:
        """Whether the machine was a simulated one."""

    def column(self, name: str) -> Floats:
        """Return one number of every step, (n,)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LogParts:
    """A log, not yet decoded beyond its header."""

    header: RunHeader
    steps: Iterator[LoggedMessage]
    """one after the other from the file"""
    outcome: Callable[[], Outcome]
    """how the run ended, known when all steps are read"""
    losses: Callable[[], tuple[str, ...]]
    """what of the file is damaged, and which steps are lost by that; known when all steps are read"""


@contextmanager
def open_log(file: Path) -> Iterator[LogParts]:
    """Read the log of a run in a stream, as a context; a last record cut off by a crash is left out.

    Raises DrawbarError when the file cannot be read or is no log, or what is known before the first step is damaged.
    """
    with reading(file) as records:
        yield _parts(records)


@contextmanager
def reading(file: Path) -> Iterator[Iterator[Logged]]:
    """Read the records of a log in a stream, as a context; see read_records.

    Raises DrawbarError when the file cannot be read or is no log, or what is known before the first step is damaged.
    """
    advice = "give the log.mcap that drawbar run or drawbar drive wrote"
    try:
        if not stat.S_ISREG(mode := file.stat().st_mode) and not stat.S_ISDIR(mode):
            raise DrawbarError(f"{file}: is a pipe or a device, not a file; {advice}")
        with file.open("rb") as stream:
            yield read_records(stream)
    except OSError as error:
        raise DrawbarError(f"{file}: cannot be read ({error.strerror}); {advice}") from error
    except _NoHeaderError as error:
        raise DrawbarError(
            f"{file}: holds no {HEADER_NAME}, which a log begins with{error}; it was cut off in its beginning, or is "
            f"no log of drawbar; {advice}"
        ) from error
    except _DAMAGE as error:
        raise DrawbarError(f"{file}: is damaged, or no log of drawbar ({error}); {advice}") from error


class _NoHeaderError(Exception):
    """A log lacks its first attachment."""


def _parts(records: Iterator[Logged]) -> LogParts:
    before = list[Damage]()
    header, outcome, losses = None, CUT_OFF, Losses()
    for record in records:
        if isinstance(record, Damage):
            before.append(record)
        elif isinstance(record, Attachment) and record.name == HEADER_NAME:
            header = record.data
            break
    if header is None:
        raise _NoHeaderError("".join(f"; {damage}" for damage in before))
    damaged = [f"{damage}: they hold what was known before the first step" for damage in before]
    losses.texts += damaged

    def steps() -> Iterator[LoggedMessage]:
        nonlocal outcome
        for record in records:
            if isinstance(record, LoggedMessage):
                if record.topic == STEP_TOPIC:
                    losses.see(record.sequence)
                    yield record
            elif isinstance(record, Metadata) and record.name == OUTCOME_NAME:
                losses.end()
                ended = outcome_of(record.metadata)
                outcome = ended or outcome
                losses.texts += [] if ended else ["how the run ended is damaged"]
            elif isinstance(record, Damage):
                losses.add(record)
        losses.end()

    try:
        decoded = msgspec.json.decode(header, type=RunHeader, dec_hook=decode_special)
    except (msgspec.MsgspecError, ValueError) as error:
        raise DamagedLogError("; ".join(damaged) or str(error)) from error
    return LogParts(header=decoded, steps=steps(), outcome=lambda: outcome, losses=lambda: tuple(losses.texts))


def outcome_of(metadata: Mapping[str, str]) -> Outcome | None:
    """Return how a run ended; None: that is damaged."""
    if metadata.get("finished") not in ("true", "false") or "reason" not in metadata:
        return None
    return Outcome(finished=metadata["finished"] == "true", reason=metadata["reason"])


def log_of(run: Path) -> Path:
    """Return the log of a run that is given by its folder or by the log itself."""
    return run / LOG_NAME if run.is_dir() else run


def read_log(file: str | os.PathLike[str]) -> RunLog:
    """Read the log of a run; a last record cut off by a crash is left out, and what is damaged is in its losses.

    file: the log, or the folder of the run.

    Raises DrawbarError when the file cannot be read or is no log, or what is known before the first step is damaged.
    """
    with open_log(log_of(demand_path("file", file))) as log:
        messages = [(decode_step(message), message.publish_time * 1e-9) for message in log.steps]
        return RunLog(
            header=log.header,
            records=tuple(record for record, _ in messages),
            wall_time=np.array([time for _, time in messages]),
            outcome=log.outcome(),
            losses=log.losses(),
        )
