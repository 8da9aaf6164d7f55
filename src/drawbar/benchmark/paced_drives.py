"""Paced drives: how far drives in processes, each at a pace, are from the same one in a single process.

`python -m drawbar.benchmark.paced_drives [PACE ...] [--path FILE --track NAME] [--isobus] [--one-receiver]`: without a
pace at 1, 2, 5 and 10; over TCP and AgOpenGPS boards' UDP, or with everything on CAN buses, the tractor's speed too.
The sensors are exact, so that a body's distance from the line is what the receivers measure; that of a trailer without
one is the estimate's. At a pace the processes' results are needed so many times sooner: delays and late steps say
whether this computer is fast enough.
"""

import argparse
import itertools
import math
import os
import sys
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from drawbar.config import Configuration, load_configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.driving.operator.front_end import FrontEnd
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import with_isobus, with_one_receiver, with_stand_ins
from drawbar.driving.stand_in.rehearsal import Rehearsal
from drawbar.driving.stand_in.stand_in_machine import SEED
from drawbar.geometry import Floats
from drawbar.guidance.path import Path as Line
from drawbar.messages import CommandMessage, ControllerState, Fixes, Mode, SupervisorState
from drawbar.messages.records import decode
from drawbar.recording.drive_records import open_drive
from drawbar.recording.log import LOG_NAME
from drawbar.signals import Flag, StepRecord
from drawbar.simulation import build_path
from drawbar.vehicle.parameters import BODIES

EXACT = (
    "machine.sensors.position=0.0",
    "machine.sensors.hitch_angle=0.0",
    "machine.sensors.speed=0.0",
    "machine.attitude.yaw.noise=0.0",
    f"machine.sensors.steering_resolution={math.radians(1.0 / 30.0)}",  # of the boards: 30 counts per degree
    *(f"machine.ground.{each}_slip.deviation=0.0" for each in ("longitudinal", "tractor")),
    *(f"machine.ground.{each}_crab.deviation=0.0" for each in ("tractor", "trailer")),
)
"""changes of a configuration after which nothing is drawn: by each engagement, and in `drawbar run`, which draws at
steps and not at ticks, one seed would be another weather"""
PROMPT = 0.025
"""delay of a command up to which a drive is compared, of its time, s: half a tick of the gate, beyond which set points
leave with the next one, and the boards' wires are late too"""
SETTLING = 50
"""steps from the place where it was engaged onto the line"""
_LONGEST = 400.0
"""of a drive, s of its own"""
_NEAR = 5.0
"""along the line, within which a body is looked for, m"""
_ENDED = (SupervisorState.STOPPED, SupervisorState.FAULT, SupervisorState.OVERRIDE, SupervisorState.ESTOP)


@dataclass(frozen=True, slots=True, kw_only=True)
class Driven:
    """A drive, from where it has settled on the line."""

    progress: Floats
    """of the tractor along the line at each step, m"""
    errors: Floats
    """(n, 2) of both bodies from the line, where the receivers are, left positive, m"""
    late: int = 0
    """steps that were late, since the start"""
    delays: Sequence[tuple[float, float]] = ()
    """from a sample's first byte until it was complete, and from there to its command, while it steered, of the drive's
    time, s"""
    load: float = 0.0
    """of one core, by all processes"""
    states: Sequence[SupervisorState] = ()
    """that were shown, each once in a row"""

    @property
    def delay(self) -> float:
        """The delay from first byte to command that 99 of 100 do not exceed, s; infinite: there was none."""
        return float(np.percentile([sum(each) for each in self.delays], 99)) if self.delays else math.inf

    @property
    def held(self) -> bool:
        """Whether the computer was fast enough: the gate was never degraded, and commands were in time."""
        slow = (SupervisorState.DEGRADED, SupervisorState.FAULT)
        return bool(len(self.errors)) and self.delay <= PROMPT and not any(each in slow for each in self.states)


def rehearse(
    configuration: Configuration, seconds: float = _LONGEST, delays: Sequence[tuple[float, float]] = ()
) -> Driven:
    """Return the drive in one process, by a clock of its own, with the seed of stand-ins.

    Args:
        configuration: with devices on this computer.
        seconds: longest time.
        delays: of an epoch, after its first message, and of its command, s: those that processes need for them, which
            are had one after the other, again and again.
    """
    line, _ = build_path(configuration)
    rehearsal, steps = Rehearsal(configuration, line, SEED, configuration.safety), []
    late = _Late(delays or [(0.0, 0.0)])
    rehearsal.links.faults |= dict.fromkeys([f"{body} receiver" for body in BODIES], late.epoch)
    rehearsal.links.faults["controller"] = late.command
    for record, _ in rehearsal.run(seconds):
        steps.append(record)
        if rehearsal.gate_state is not None and rehearsal.gate_state.state in _ENDED[:-1]:
            break
    progress, errors = _errors(steps, line, two_receivers=configuration.has_trailer_receiver)
    return Driven(progress=progress, errors=errors)


class _Late:
    """Lets a rehearsal have the delays of a drive in processes, each where it was, counted from the first command."""

    def __init__(self, delays: Sequence[tuple[float, float]]) -> None:
        self._all, self._delays = delays, itertools.cycle(delays)
        self._now, self._time, self._drives = (0.0, 0.0), -math.inf, False

    def epoch(self, time: float, data: bytes) -> list[tuple[float, bytes]]:
        """Delay all messages of an instant but the first."""
        if time != self._time:
            self._now, self._time = next(self._delays), time
            return [(0.0, data)]
        return [(self._now[0], data)]

    def command(self, time: float, data: bytes) -> list[tuple[float, bytes]]:
        message = decode(data, CommandMessage)
        if not self._drives and isinstance(message, CommandMessage) and message.mode is Mode.DRIVE:
            self._drives, self._delays = True, itertools.cycle(self._all)
        return [(self._now[1], data)]


def drive(configuration: Configuration, run: Path, pace: int, seconds: float = _LONGEST) -> Driven:
    """Return a drive in processes, over sockets, on stand-ins.

    Args:
        configuration: with devices on this computer.
        run: folder of its log.
        pace: of all processes.
        seconds: longest time, of the drive's own.
    """
    (run / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
    states: list[SupervisorState] = []
    with DriveProcesses(configuration, run, stand_ins=True, pace=pace) as processes:
        front, clock = FrontEnd(processes, demonstrates=True), processes.options.clock.from_now()
        used = -_processor_time(processes)
        while clock() < seconds and not front.is_over and not processes.ended():
            front.wait(0.05)
            if front.state is not None and front.state.state not in states[-1:]:
                states.append(front.state.state)
        if gone := processes.ended():
            print(f"ended: {', '.join(gone)}: {processes.last_output(gone)}", file=sys.stderr)
            states.append(SupervisorState.FAULT)
        used, lasted = used + _processor_time(processes), clock() / pace
        front.close()
    steps, delays, late = _read(run / LOG_NAME)
    line = build_path(configuration)[0]
    progress, errors = _errors(steps, line, two_receivers=configuration.has_trailer_receiver)
    return Driven(progress=progress, errors=errors, late=late, delays=delays, load=used / lasted, states=states)


def _errors(steps: Iterable[StepRecord], line: Line, *, two_receivers: bool) -> tuple[Floats, Floats]:
    """Return along and across the line where both bodies were in the steps that steered, but the first ones."""
    rows, near = [], [0.0, 0.0]
    for record in steps:
        if record.flags & Flag.RELEASED or not record.status.is_new_command:
            continue
        seen, drawn, row = record.measurement, record.estimate.trailer, []
        trailer = (seen.trailer_x, seen.trailer_y) if two_receivers else (drawn.x, drawn.y)
        for body, (x, y) in enumerate(((seen.tractor_x, seen.tractor_y), trailer)):
            if not math.isfinite(x + y):
                row += [math.nan, math.nan]
                continue
            near[body], error = line.project(x, y, near[body] - _NEAR, near[body] + _NEAR)
            row += [near[body], error]
        rows.append(row)
    found = np.array(rows[SETTLING:]).reshape(-1, 4)
    found = found[np.isfinite(found).all(axis=1)]
    return found[:, 0], found[:, [1, 3]]


def _read(log: Path) -> tuple[list[StepRecord], list[tuple[float, float]], int]:
    """Return what a log holds of steps, of the delays (s) that `Driven` has, and of late steps."""
    with open_drive(log) as opened:
        records = list(opened)
    steps = [each for each in records if isinstance(each, StepRecord)]
    late = max((each.overruns for each in records if isinstance(each, ControllerState)), default=0)
    fixes = [each for each in records if isinstance(each, Fixes)]
    commands = [each for each in records if isinstance(each, CommandMessage)]
    return steps, _delays(fixes, commands), late


def _delays(fixes: Sequence[Fixes], commands: Sequence[CommandMessage]) -> list[tuple[float, float]]:
    """Return of each epoch since the first command to drive how long it took to come, and its command after it, s."""
    begin = min((each.time for each in commands if each.mode is Mode.DRIVE), default=math.inf)
    epochs = sorted((each.time, each.first_byte) for each in fixes if each.time >= begin)
    complete, first = np.array(epochs, dtype=float).reshape(-1, 2).T
    left = np.sort(np.array([each.time for each in commands], dtype=float))
    found = left.searchsorted(complete)
    answered = found < len(left)
    answers = left[found[answered]] - complete[answered]
    return [(1e-9 * a, 1e-9 * b) for a, b in zip((complete - first)[answered], answers, strict=True)]


def _processor_time(processes: DriveProcesses) -> float:
    """Return what all processes of a drive that are there have used of the processor, s."""
    used = 0
    for process in processes.by_name.values():
        if process.poll() is not None:
            continue
        fields = Path(f"/proc/{process.pid}/stat").read_text("utf-8").rpartition(")")[2].split()
        used += int(fields[11]) + int(fields[12])
    return used / os.sysconf("SC_CLK_TCK")


def differences(one: Driven, other: Driven) -> tuple[float, float, float]:
    """Return by how much two drives differ: mean and largest distance from the line, and at single places, m."""
    low = max(each.progress[0] for each in (one, other))
    high = min(each.progress[-1] for each in (one, other))
    inside = [(each.progress >= low) & (each.progress <= high) for each in (one, other)]
    sizes = [np.abs(each.errors[where]) for each, where in zip((one, other), inside, strict=True)]
    mean = np.abs(sizes[0].mean(axis=0) - sizes[1].mean(axis=0)).max()
    largest = np.abs(sizes[0].max(axis=0) - sizes[1].max(axis=0)).max()
    places = [np.interp(one.progress[inside[0]], other.progress, other.errors[:, body]) for body in range(2)]
    apart = np.abs(one.errors[inside[0]] - np.stack(places, axis=1)).max()
    return float(mean), float(largest), float(apart)


def main() -> int:
    """Drive and print."""
    parser = argparse.ArgumentParser(prog="python -m drawbar.benchmark.paced_drives")
    parser.add_argument("paces", metavar="PACE", type=int, nargs="*", default=[1, 2, 5, 10])
    parser.add_argument("--path", metavar="FILE", help="of a recorded line; default: a figure-eight")
    parser.add_argument("--track", metavar="NAME", default="", help="of the line, where the file holds several")
    parser.add_argument("--isobus", action="store_true", help="everything on CAN buses instead of TCP and UDP")
    parser.add_argument("--one-receiver", action="store_true", help="with two antennas, on the tractor, alone")
    given = parser.parse_args()
    recorded = [f"path.file={given.path}", f"path.track={given.track}"]
    plain = load_configuration("articulated", [*(recorded if given.path else ["path.radii=[8.0]"]), *EXACT])
    configuration = with_isobus(plain) if given.isobus else with_stand_ins(plain)
    configuration = with_one_receiver(configuration) if given.one_receiver else configuration
    table = Table(title="drives in processes beside the same in one process, its epochs and commands as late as there")
    columns = ("pace", "steps", "late", "delay", "of a core", "mean", "largest", "anywhere", "held")
    for column in columns:
        table.add_column(column, justify="right")
    for pace in given.paces:
        with tempfile.TemporaryDirectory(prefix="drawbar-paced-") as folder:
            driven = drive(configuration, Path(folder), pace)
        table.add_row(*_row(driven, pace, rehearse(configuration, delays=driven.delays)))
    terminal = Console()
    terminal.print(table)
    load = " ".join(f"{each:.1f}" for each in os.getloadavg())
    terminal.print(f"differences in mm; delay: ms, of 99 of 100 commands; load of this computer: {load}")
    return 0


def _row(driven: Driven, pace: int, alone: Driven) -> list[str]:
    apart = differences(driven, alone) if len(driven.errors) else (math.nan,) * 3
    return [
        *map(str, (pace, len(driven.errors), driven.late)),
        f"{1e3 * driven.delay:.0f}",
        f"{100.0 * driven.load:.0f} %",
        *(f"{1e3 * each:.1f}" for each in apart),
        "yes" if driven.held else f"no: {driven.states[-1].name}",
    ]


if __name__ == "__main__":
    sys.exit(main())
