"""Load: what the console costs, and how soon a step is at the browsers, beside a drive of stand-ins on this computer.

`python -m drawbar.console.load [SECONDS]`: phases, each twice: nobody looks; one browser; eight, of which one reads
nothing; and one floods the console besides. Delays are those of one computer; a browser's own painting is not in them.
Then a Chromium, if there is one, paints map and plots, as fast as it can and as slow as a phone (painting.py).
"""

import asyncio
import os
import socket
import sys
import tempfile
import time
from collections.abc import Callable, Coroutine, Sequence
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from drawbar.config import load_configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.console.browsers import Place, Seen, draws, floods, reads_nothing
from drawbar.console.drawing import moving
from drawbar.console.painting import Painted, paint
from drawbar.driving.messaging.console_options import ConsoleOptions
from drawbar.driving.messaging.process_options import CONSOLE
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.messages import CommandMessage, Fixes
from drawbar.recording.drive_records import open_drive
from drawbar.recording.log import LOG_NAME
from drawbar.signals import StepRecord

Browser = Callable[[str, Seen], Coroutine[Any, Any, None]]
_PHASES: dict[str, tuple[Browser, ...]] = {
    "nobody": (),
    "1": (draws,),
    "8, one slow": (*[draws] * 7, reads_nothing),
    "8, one slow, one floods": (*[draws] * 6, reads_nothing, floods),
}
_ROUNDS = 2
_LAST = 1_000_000_000
"""before the end of a phase, in which steps may not be seen any more, ns"""
_SETTLING = 8.0
"""until everything runs, s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Phase:
    """A time in which so many look."""

    looking: str
    begin: int
    end: int
    """monotonic, ns"""
    processor: float
    """time of the console's process, s"""
    seen: Sequence[Seen]


@dataclass(frozen=True, slots=True)
class Drive:
    """What the log holds of the control loop, all times monotonic, ns."""

    late: Sequence[tuple[int, int]]
    """when each command of a step left, and how long after its epoch was complete"""
    steps: Sequence[tuple[int, Place]]
    """when each step's command left, and where both bodies were estimated"""


def main() -> int:
    """Measure and print."""
    duration = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    with tempfile.TemporaryDirectory(prefix="drawbar-load-") as folder:
        run = Path(folder) / "run"
        run.mkdir()
        phases, painted = _drive(run, duration)
        drive = _read(run / LOG_NAME)
    print_figures(phases, drive)
    print_painting(painted, drive)
    return 0


def _drive(run: Path, duration: float) -> tuple[list[Phase], list[Painted]]:
    configuration = with_stand_ins(load_configuration("articulated"))
    (run / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    options = ConsoleOptions(folder="", configuration="", runs=str(run), port=port)
    with DriveProcesses(configuration, run, stand_ins=True, console=options) as processes:
        return asyncio.run(_measure(f"http://127.0.0.1:{port}/", processes.by_name[CONSOLE].pid, duration))


async def _measure(page: str, console: int, duration: float) -> tuple[list[Phase], list[Painted]]:
    await asyncio.sleep(_SETTLING)
    phases = [
        await _phase(name, page, console, duration)
        for name, _ in zip(cycle(_PHASES), range(_ROUNDS * len(_PHASES)), strict=False)
    ]
    return phases, await paint(page, duration)


async def _phase(name: str, page: str, console: int, duration: float) -> Phase:
    seen = [Seen() for _ in _PHASES[name]]
    browsers = [asyncio.create_task(each(page, what)) for each, what in zip(_PHASES[name], seen, strict=True)]
    await asyncio.sleep(0.2 * duration)  # the pages are opened
    begin, before = time.monotonic_ns(), processor_time(console)
    await asyncio.sleep(0.8 * duration)
    phase = Phase(
        looking=name, begin=begin, end=time.monotonic_ns(), processor=processor_time(console) - before, seen=seen
    )
    for browser in browsers:
        browser.cancel()
    ended = await asyncio.gather(*browsers, return_exceptions=True)
    for error in ended:
        if isinstance(error, Exception):
            raise error
    return phase


def processor_time(process: int) -> float:
    """Return what a process has used of the processor, s."""
    fields = Path(f"/proc/{process}/stat").read_text("utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _read(file: Path) -> Drive:
    complete, steps = [], []
    command: CommandMessage | None = None
    with open_drive(file) as records:
        for record in records:
            if isinstance(record, Fixes):
                complete.append(record.time)
            elif isinstance(record, CommandMessage):
                command = record
            elif isinstance(record, StepRecord) and command is not None:
                place = moving(record)
                steps.append((command.time, place.bodies if place is not None else ()))
    epochs = np.sort(np.array(complete))
    left = np.array([time for time, _ in steps])
    return Drive(list(zip(left, left - epochs[epochs.searchsorted(left, "right") - 1], strict=True)), steps)


def print_figures(phases: Sequence[Phase], drive: Drive) -> None:
    """Print a line for each kind of phase."""
    table = Table(title="the console beside a drive")
    table.add_column("browsers")
    for column in ("% of a core", "pictures/s", "step to browser: median", "p99", "most", "command's delay: p99"):
        table.add_column(column, justify="right")
    for name in _PHASES:
        table.add_row(name, *_row([phase for phase in phases if phase.looking == name], drive))
    terminal = Console()
    terminal.print(table)
    ends = sum(each.ends for phase in phases for each in phase.seen)
    load = " ".join(f"{each:.1f}" for each in os.getloadavg())
    terminal.print("delays in ms; a command's: after its epoch was complete")
    terminal.print(f"connections that the console ended or refused: {ends}; load of this computer: {load}")


def _row(phases: Sequence[Phase], drive: Drive) -> list[str]:
    spans = [(phase.begin, phase.end) for phase in phases]
    length = sum(end - begin for begin, end in spans) * 1e-9
    processor = 100.0 * sum(phase.processor for phase in phases) / length
    late = [delay for time, delay in drive.late if any(begin <= time <= end for begin, end in spans)]
    drawing = [each for phase in phases for each in phase.seen if each.pictures]
    count = sum(begin <= time <= end for each in drawing for time, _ in each.pictures for begin, end in spans)
    rate = f"{count / length / max(len(drawing) // len(phases), 1):.1f}" if drawing else ""
    delays = [
        delay
        for phase in phases
        for each in phase.seen
        for delay in _delays(
            each.pictures, [step for step in drive.steps if phase.begin <= step[0] <= phase.end - _LAST]
        )
    ]
    shown = _milliseconds([1e-9 * delay for delay in delays], (0.5, 0.99, 1.0))
    return [f"{processor:.1f}", rate, *shown, f"{float(np.quantile(late, 0.99)) * 1e-6:.1f}"]


def print_painting(painted: Sequence[Painted], drive: Drive) -> None:
    """Print a line for each page that was painted."""
    terminal = Console()
    if not painted:
        terminal.print("painting was not measured: it needs playwright and a Chromium")
        return
    table = Table(title="painted by a Chromium at 360 px")
    table.add_column("page")
    table.add_column("slower", justify="right")
    for column in ("painted/s", "message to screen: median", "p99", "step to screen: median", "p99", "most"):
        table.add_column(column, justify="right")
    for each in painted:
        steps = [step for step in drive.steps if each.begin <= step[0] <= each.end - _LAST]
        delays = [1e-9 * delay for delay in _delays(each.places, steps)]
        rate = f"{len(each.took) / (1e-9 * (each.end - each.begin)):.1f}"
        table.add_row(
            each.name,
            f"{each.slower}×",
            rate,
            *_milliseconds(each.took, (0.5, 0.99)),
            *_milliseconds(delays, (0.5, 0.99, 1.0)),
        )
    terminal.print(table)


def _milliseconds(durations: Sequence[float], shares: Sequence[float]) -> list[str]:
    return [f"{each * 1e3:.0f}" for each in np.quantile(durations, shares)] if durations else [""] * len(shares)


def _delays(pictures: Sequence[tuple[int, Place]], steps: Sequence[tuple[int, Place]]) -> list[int]:
    """Return how long after its command each of some steps was first seen, ns."""
    first: dict[Place, int] = {}
    for time_seen, place in pictures:
        first.setdefault(place, time_seen)
    return [first[place] - left for left, place in steps if place in first]


if __name__ == "__main__":
    sys.exit(main())
