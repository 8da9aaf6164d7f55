"""Push record: what a sensor reported while a bare valve or motor was pushed, and what that shows of it. Pure.

A file of rows time (s), drive (-1 to 1), angle (degrees, left positive), written by whatever drives the actuator.
docs/calibration.md says what it is to do.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from drawbar.driving.calibrating import Found
from drawbar.errors import DrawbarError
from drawbar.geometry import Floats
from drawbar.guidance.importers.text import is_number, numbers
from drawbar.machine.hardware.valve_calibration import MOVED, RUNS, PushRecord, actuator_dynamics, dead_band

_RISES = 0.03
"""from push to push, in a run for the dead band, at most"""
_MOST = 200_000
"""rows of a file"""
_STEP = 0.2
"""longest time between two rows within a push, s"""
SIDES = ("left", "right")


@dataclass(frozen=True, slots=True, kw_only=True)
class PushFile:
    """What a file holds: n rows, and the pushes in them."""

    times: Floats
    """(n,) s"""
    drives: Floats
    """(n,) -1 to 1"""
    angles: Floats
    """(n,) rad, left positive"""
    runs: dict[str, list[list[PushRecord]]]
    """whose drive rises from push to push, by the side to which they turn"""
    pushes: dict[str, list[PushRecord]]
    """all others, by side"""

    @classmethod
    def of(cls, data: bytes, name: str) -> "PushFile":
        """Return what a file holds.

        Raises:
            DrawbarError: it is no such file; says where and why.
        """
        times, drives, angles = _columns(data, name)
        pushes = list(_pushes(times, drives, angles))
        moves = sum(push.moved * push.drive for push in pushes if abs(push.moved) > MOVED)
        if not moves:
            raise DrawbarError(
                f"{name}: holds no push that moved; write time, drive, angle, without gaps of more than {_STEP} s"
            )
        left = 1.0 if moves > 0.0 else -1.0
        runs: dict[str, list[list[PushRecord]]] = {side: [] for side in SIDES}
        single: dict[str, list[PushRecord]] = {side: [] for side in SIDES}
        for run in _rising(pushes):
            side = SIDES[left * run[0].drive < 0.0]
            if len(run) >= RUNS:
                runs[side].append(run)
            else:
                single[side] += [replace(push, drive=left * push.drive) for push in run]
        return cls(times=times, drives=drives, angles=angles, runs=runs, pushes=single)

    def found(self) -> Iterator[Found]:
        """Yield dead band, full rate, lag and dead time of each side."""
        for side in SIDES:
            band = dead_band(self.runs[side])
            yield Found(name=f"{side}: dead band", value=band, sets={})
            if not band.accepted:
                continue
            dynamics = actuator_dynamics(self.pushes[side], dead_band=band.value)
            yield Found(name=f"{side}: full rate", value=dynamics.size, sets={})
            yield Found(name=f"{side}: lag", value=dynamics.lag, sets={})
            yield Found(name=f"{side}: dead time", value=dynamics.dead_time, sets={})


def _columns(data: bytes, name: str) -> tuple[Floats, Floats, Floats]:
    try:
        lines = [line.strip() for line in data.decode("utf-8-sig").splitlines()]
    except UnicodeDecodeError as error:
        raise DrawbarError(f"{name}: byte {error.start} is not UTF-8 text; give a text file") from None
    first = 1 if lines and not is_number(lines[0].split(",")[0]) else 0  # a row of names
    rows = [numbers(line, 3, f"{name}:{i}", "a number") for i, line in enumerate(lines[first:], first + 1) if line]
    if not 10 <= len(rows) <= _MOST:
        raise DrawbarError(f"{name}: has {len(rows)} rows; 10 to {_MOST} are allowed")
    table = np.array(rows)
    if not np.isfinite(table).all():
        raise DrawbarError(f"{name}: holds a number that is not finite; leave its row out")
    times, drives, degrees = table.T
    if not (np.diff(times) > 0.0).all():
        raise DrawbarError(f"{name}: its times do not rise from row to row; write seconds of one clock")
    if not (np.abs(drives) <= 1.0).all():
        raise DrawbarError(f"{name}: holds a drive beyond ±1; write shares of the full drive")
    if not (np.abs(degrees) <= 180.0).all():
        raise DrawbarError(f"{name}: holds an angle beyond ±180°; write degrees")
    return times, drives, np.radians(degrees)


def _pushes(times: Floats, drives: Floats, angles: Floats) -> Iterator[PushRecord]:
    """Yield each push: from the first row with a drive, after rest, to the last row before the next push."""
    begins = np.flatnonzero((drives[1:] != 0.0) & (drives[:-1] == 0.0)) + 1
    for begin, end in pairwise([*begins.tolist(), len(times)]):
        held = begin + int(np.argmax(np.append(drives[begin:end], 0.0) != drives[begin]))  # first row after the push
        if held == end or not (np.diff(times[begin:end]) <= _STEP).all():
            continue  # cut off, or silent in between
        since = times[begin:end] - times[begin]
        yield PushRecord(
            drive=float(drives[begin]),
            duration=float(times[held] - times[begin]),
            times=since,
            angles=angles[begin:end] - angles[begin],
        )


def _rising(pushes: list[PushRecord]) -> Iterator[list[PushRecord]]:
    """Yield stretches of pushes to one side whose drive rises by a little from push to push."""
    run: list[PushRecord] = []
    for push in pushes:
        rise = math.copysign(1.0, push.drive) * (push.drive - run[-1].drive) if run else 0.0
        if run and not (run[-1].drive * push.drive > 0.0 and 0.0 < rise <= _RISES):
            yield run
            run = []
        run.append(push)
    if run:
        yield run
