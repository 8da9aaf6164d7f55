"""Columns of a long log: read without the steps' objects and without what is not asked for.

Positions, times and progress are kept as they are, all else in single precision, and a number that stays the same for
some time once.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.recording.encoding import is_json
from drawbar.recording.log import Columns, Outcome, RunHeader, open_log, read_log
from drawbar.recording.stream import LoggedMessage
from drawbar.step.layout import StepLayout
from drawbar.vehicle.parameters import BODIES

_BLOCK = 1000
"""steps that are read together"""
_SLIPS = ("longitudinal_slip", "tractor_slip", "steering_offset", "tractor_crab", "trailer_crab")
_STEERINGS = ("tractor_steering", "trailer_steering")
_REPORTED: tuple[str, ...] = (
    *(f"measurement.{name}" for name in ("time", "speed", "hitch_angle")),
    *(f"measurement.{body}_{name}" for body in BODIES for name in ("x", "y", "roll", "pitch", "fix_age")),
    "measurement.tractor_yaw",
    *(f"actuation.{body}_roll_{name}" for body in BODIES for name in ("offset", "deviation")),
    "actuation.fix_latency",
    *(f"estimate.{body}.{name}" for body in BODIES for name in ("x", "y", "yaw")),
    *(f"estimate.{name}" for name in ("speed", "hitch_angle", "trailer_slip", *_SLIPS)),
    *(f"estimate.{body}_fix" for body in BODIES),
    *(f"reference.{body}.{name}" for body in BODIES for name in ("progress", "lateral_error")),
    *(f"reference.{body}.closest.{place}" for body in BODIES for place in range(3)),
    *(f"reference.{body}.line_{axis}" for body in BODIES for axis in "xy"),
    *(f"{body}_steering.{name}" for body in BODIES for name in ("command", "ancillary", "saturated", "margin")),
    "command.speed",
    *(f"{each}_times.{phase}" for each in ("estimator", *BODIES) for phase in ("prepare", "feedback")),
    "solver_failures",
    "gate",
    "status",
    "flags",
)
_REPORTED_OF_TRUTH: tuple[str, ...] = (
    *(f"truth.{body}.{name}" for body in BODIES for name in ("x", "y", "yaw")),
    *(f"truth.{name}" for name in (*_SLIPS, *_STEERINGS)),
    *(f"truth.{body}_{angle}" for body in BODIES for angle in ("roll", "pitch")),
)
_REPORTED_WITHOUT_TRUTH: tuple[str, ...] = (
    *(f"{source}.{name}" for source in ("measurement", "estimate") for name in _STEERINGS),
)
"""in place of what is not known"""
WIDE = (".x", ".y", "_x", "_y", ".time", ".progress", ".closest.0", ".closest.1")
"""how names of numbers end that single precision would spoil"""
_MISSING = np.full(1, np.nan)

Column = NDArray[np.float32] | NDArray[np.float64]


class Block(NamedTuple):
    """Numbers of m steps that follow each other."""

    wall_time: Floats
    """(m,): s since 1970"""
    columns: dict[str, Column]
    """(m,) each, or (1,) of a number that stays the same"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ColumnLog:
    """The numbers of a log that were asked for: n steps."""

    header: RunHeader
    outcome: Outcome
    losses: tuple[str, ...]
    """what of the file is damaged, and which steps are lost by that"""
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
        self.names.index(name)
        parts = (np.broadcast_to(block.columns[name], block.wall_time.shape) for block in self.blocks)
        return np.concatenate([np.empty(0), *parts], dtype=np.float64)


def reported(*, has_truth: bool) -> tuple[str, ...]:
    """Return what the report of a run is made of, whose truth is known or not."""
    return (*_REPORTED, *(_REPORTED_OF_TRUTH if has_truth else _REPORTED_WITHOUT_TRUTH))


def read_columns(file: Path, names: Sequence[str] | None = None) -> Columns:
    """Read columns of a log in a stream, by default those of its report; errors as read_log.

    Of an older log, whose steps are JSON, all is read.
    """
    with open_log(file) as log:
        messages = list(islice(log.steps, _BLOCK))
        if messages and is_json(messages[0].schema):
            return read_log(file)
        has_truth = bool(messages) and bool(np.isfinite(_block(messages, ["truth.time"]).columns["truth.time"]).any())
        wanted = reported(has_truth=has_truth) if names is None else tuple(names)
        blocks = list[Block]()
        while messages:
            blocks.append(_block(messages, wanted))
            messages = list(islice(log.steps, _BLOCK))
        return ColumnLog(
            header=log.header,
            outcome=log.outcome(),
            losses=log.losses(),
            has_truth=has_truth,
            names=wanted,
            blocks=blocks,
        )


def _block(messages: Sequence[LoggedMessage], names: Sequence[str]) -> Block:
    """Return numbers of steps that follow each other; what their schema lacks is NaN."""
    layout = StepLayout.of_schema(messages[0].schema)
    table = layout.table([message.data for message in messages], [name for name in names if layout.holds(name)])
    with np.errstate(over="ignore"):
        columns = {name: _kept(name, table[name]) if name in table else _MISSING for name in names}
    return Block(np.array([message.publish_time for message in messages]) * 1e-9, columns)


def _kept(name: str, values: NDArray[Any]) -> Column:
    """Return a column as it is kept; infinity is as good as missing."""
    values = values.astype(np.float64)
    values[~np.isfinite(values)] = np.nan
    alike = (values == values[0]).all() or np.isnan(values).all()
    values = values[: 1 if alike else None].copy()
    return values if name.endswith(WIDE) else values.astype(np.float32)
