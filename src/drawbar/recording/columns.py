"""A long log as columns: read in a stream, without the steps' objects and without what is not asked for.

Half a million steps (100 km at 1 m/s) take some 150 MB: positions, times and progress as they are, all else in single
precision.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import islice
from operator import attrgetter
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from drawbar.errors import DrawbarError
from drawbar.geometry import Floats
from drawbar.recording.log import Outcome, RunHeader, open_log
from drawbar.recording.stream import LoggedMessage

_BLOCK = 2000
"""steps that are Python objects at the same time"""
_POSE = ("x", "y", "yaw")
_SLIPS = ("longitudinal_slip", "tractor_slip", "steering_offset", "tractor_crab", "trailer_crab")
_STEERINGS = ("tractor_steering", "trailer_steering")
_BODIES = ("tractor", "trailer")
REPORTED: tuple[str, ...] = (
    *(f"measurement.{name}" for name in ("time", "tractor_x", "tractor_y", "speed", "hitch_angle", *_STEERINGS)),
    *(f"estimate.{body}.{name}" for body in _BODIES for name in _POSE),
    *(f"estimate.{name}" for name in ("speed", "hitch_angle", "trailer_slip", *_SLIPS, *_STEERINGS)),
    *(f"estimate.{body}_fix" for body in _BODIES),
    *(f"reference.{body}.{name}" for body in _BODIES for name in ("progress", "lateral_error", "closest.2")),
    *(f"{body}_steering.{name}" for body in _BODIES for name in ("command", "ancillary", "saturated", "margin")),
    "command.speed",
    *(f"truth.{body}.{name}" for body in _BODIES for name in _POSE),
    *(f"truth.{name}" for name in (*_SLIPS, *_STEERINGS)),
    *(f"truth.{body}_{angle}" for body in _BODIES for angle in ("roll", "pitch")),
    *(f"{each}_times.{phase}" for each in ("estimator", *_BODIES) for phase in ("prepare", "feedback")),
    *(f"measurement.{body}_roll" for body in _BODIES),
    "solver_failures",
    "gate",
    "flags",
)
"""what the report of a run is made of"""
_WIDE = (".x", ".y", "_x", "_y", ".time", ".progress")
"""how names of numbers end that single precision would spoil"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ColumnLog:
    """The numbers of a log that were asked for: n steps."""

    header: RunHeader
    wall_time: Floats
    """(n,): s since 1970"""
    outcome: Outcome
    has_truth: bool
    blocks: Mapping[str, Sequence[np.ndarray[Any, Any]]]
    """by name, one after the other"""

    @property
    def steps(self) -> int:
        """How many."""
        return len(self.wall_time)

    def column(self, name: str) -> Floats:
        """Return one number of every step, (n,); see RunLog.column. Raises KeyError for one not asked for."""
        blocks = self.blocks[name]
        return np.concatenate(blocks).astype(np.float64) if blocks else np.empty(0)


def read_columns(file: Path, names: Sequence[str] = REPORTED) -> ColumnLog:
    """Read columns of a log in a stream; errors as read_log."""
    blocks: dict[str, list[np.ndarray[Any, Any]]] = {name: [] for name in names}
    times: list[Floats] = []
    has_truth = False
    with open_log(file) as log:
        while messages := list(islice(log.steps, _BLOCK)):
            has_truth = has_truth or b'"truth":null' not in messages[0].data
            for name, values in _block(messages, tuple(names), has_truth=has_truth):
                blocks[name].append(values)
            times.append(np.array([message.publish_time * 1e-9 for message in messages]))
        return ColumnLog(
            header=log.header,
            wall_time=np.concatenate([*times, np.empty(0)]),
            outcome=log.outcome(),
            has_truth=has_truth,
            blocks=blocks,
        )


def _block(
    messages: list[LoggedMessage], names: tuple[str, ...], *, has_truth: bool
) -> Iterator[tuple[str, np.ndarray[Any, Any]]]:
    """Yield the columns of some steps."""
    present = names if has_truth else tuple(name for name in names if not name.startswith("truth."))
    decode, pick = _reader(present)
    try:
        rows = np.array([pick(decode(message.data)) for message in messages], dtype=np.float64)
    except msgspec.ValidationError as error:
        raise DrawbarError(f"a step lacks what every step of drawbar has ({error})") from error
    found = dict(zip(present, rows.T, strict=True))
    missing = np.full(len(messages), np.nan)
    for name in names:
        kind = np.float64 if name.endswith(_WIDE) else np.float32
        yield name, found.get(name, missing).astype(kind)


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
        return msgspec.defstruct(name, fields, array_like=True)
    members = [(key, bool | float | None if below is None else _struct(key, below)) for key, below in tree.items()]
    return msgspec.defstruct(name, members)
