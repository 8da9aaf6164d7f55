"""`drawbar drive`: drive a real machine, or stand-ins of all its devices on this computer."""

import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path as FilePath
from shutil import rmtree
from typing import TYPE_CHECKING, Annotated

import typer

from drawbar.cli.drive_choices import (
    LIVE_PORT,
    chosen_track,
    configured,
    demand_no_live_port,
    demand_no_pages,
    demand_real_time,
    demand_what_is_remembered,
    tell_room,
)
from drawbar.cli.options import ConfigurationName, Pace, changing, compiling, console, line_changes, written
from drawbar.cli.pages import Pages, address, free_port, takes_pages
from drawbar.cli.report import show_and_write
from drawbar.configurations import CONFIGURATION_NAME

LOCAL = "127.0.0.1"
NO_KEYS = "standard input is no terminal: no key is read; use a terminal, or --console"
_NOT_THERE = (
    "{folder}: the log is not there any more: the folder was moved or removed, or its disk unmounted, during the "
    "drive; where it still exists, `drawbar report` reads it"
)
_NOT_WRITTEN = "the disk is so slow that the recorder was ended before it had written all: the end of the drive is lost"

if TYPE_CHECKING:
    from drawbar.cli.interrupts import Interrupts
    from drawbar.config import Configuration
    from drawbar.driving.messaging.console_options import ConsoleOptions
    from drawbar.driving.processes.drive_processes import DriveProcesses


Path = Annotated[
    str | None,
    typer.Option(help="recorded line: AgOpenGPS field folder, CSV (x,y) or GeoJSON; default: the configuration's own"),
]
Track = Annotated[
    str, typer.Option(metavar="NAME", help="line of path.file; nearest: the one at which the vehicle stands now")
]
Folder = Annotated[
    FilePath | None,
    typer.Option(parser=written, metavar="PATH", help="folder for log and report; default: a new one in runs/"),
]
ByHand = Annotated[bool, typer.Option("--by-hand", help="with stand-ins: engage by the keys, as on a machine")]
Shadow = Annotated[
    bool, typer.Option("--shadow", help="steer nothing: compare what would be commanded with what the driver does")
]
Remember = Annotated[
    bool,
    typer.Option(
        "--remember",
        help="keep dead time, lag and rate of the steerings for the next drive, in the calibrated file",
    ),
]
Live = Annotated[bool, typer.Option("--live", help="show the log while it grows, to Foxglove on this computer")]
LivePort = Annotated[int, typer.Option(min=0, max=65535, help="of --live; 0: a free one")]
Seconds = Annotated[float, typer.Option(min=0.0, help="duration of the drive, s; 0: until it is ended")]
WithConsole = Annotated[bool, typer.Option("--console", help="serve the operator's pages, and engage there")]


@takes_pages
def drive(
    configuration: ConfigurationName = "articulated",
    changes: Annotated[list[str] | None, changing("speed=0.8")] = None,
    path: Path = None,
    track: Track = "",
    out: Folder = None,
    by_hand: ByHand = False,
    shadow: Shadow = False,
    remember: Remember = False,
    live: Live = False,
    live_port: LivePort = LIVE_PORT,
    seconds: Seconds = 0.0,
    pace: Pace = 1,
    with_console: WithConsole = False,
    *,
    pages: Pages,
) -> None:
    """Drive the machine that the configuration's devices name; without devices, stand-ins on this computer.

    With --pace, stand-ins alone: all clocks and time-outs of the drive are so many times as fast.
    """
    from drawbar.cli.interrupts import Interrupts
    from drawbar.driving.processes.drive_processes import DriveProcesses
    from drawbar.extras import require_extra

    options = _console_options(pages, out, pace) if with_console else None
    if not with_console:
        demand_no_pages(pages)
    if not live:
        demand_no_live_port(live_port)
    require_extra("drawbar drive", "machine")
    if remember:
        demand_what_is_remembered(configuration, changes or [], shadow=shadow)
    given = [*line_changes(path, ""), *(changes or [])]
    changes = [*line_changes(None, chosen_track(configuration, track, given)), *given]
    config, stand_ins = configured(configuration, changes, pace)
    shown = _shown_at(live_port) if live else None
    folder = _new_folder(out, config)
    with _removed_unless_done(folder):
        tell_room(folder, config)
        _compile(config)
    demonstrates = stand_ins and not (by_hand or shadow or with_console)
    with Interrupts() as interrupts:
        processes = DriveProcesses(
            config, folder, stand_ins=stand_ins, shadow=shadow, pace=pace, live=shown, console=options
        )
        failed = _run(processes, folder, options, interrupts, demonstrates=demonstrates, seconds=seconds)
        _report(folder, FilePath(configuration) if remember else None)
    if failed:
        raise SystemExit(1)


def _console_options(pages: Pages, out: FilePath | None, pace: int) -> "ConsoleOptions":
    """Return the options of the console that goes with the drive; refuse what it cannot be."""
    from drawbar.extras import require_extra

    require_extra("drawbar drive --console", "machine", "console")
    demand_real_time(pace)
    return pages.options(folder="", configuration="", runs=str(out.parent if out else "runs"))


def _compile(config: "Configuration") -> None:
    """Compile the control step, which refuses what it cannot drive; print what is to be known of the path before."""
    from drawbar.driving.loop.controller import Controller
    from drawbar.driving.loop.field_fence import build_fence
    from drawbar.recording.header import path_notes
    from drawbar.simulation import build_path

    path, drivable = build_path(config)
    for note in path_notes(config, path, drivable):
        console.print(note, soft_wrap=True)
    if (fence := build_fence(config)) is not None and (outside := fence.outside(path)) > 0.0:
        console.print(
            f"{outside:.0f} m of the line lie more than {config.path.beyond_boundary:g} m outside the field's "
            "boundary, where the vehicle is stopped (path.beyond_boundary)",
            soft_wrap=True,
        )
    with compiling():
        Controller(config, path, config.safety.fingerprint())


def _run(
    processes: "DriveProcesses",
    folder: FilePath,
    options: "ConsoleOptions | None",
    interrupts: "Interrupts",
    *,
    demonstrates: bool,
    seconds: float,
) -> bool:
    """Start the processes and show the drive; return whether it failed."""
    from drawbar.driving.messaging.process_options import RECORDER
    from drawbar.driving.processes.drive_processes import MESSAGES_NAME
    from drawbar.driving.processes.process_output import crashes_written

    with ExitStack() as started:
        with console.status("starting the processes …"), _removed_unless_done(folder):
            started.enter_context(crashes_written(folder / MESSAGES_NAME))
            started.enter_context(processes)
        _tell_said(processes.output())
        if options is not None:
            console.print(f"the console is at {address(options)}", soft_wrap=True)
        elif not (demonstrates or sys.stdin.isatty()):
            console.print(NO_KEYS, style="yellow", soft_wrap=True)
        failed = _drive(processes, interrupts, demonstrates=demonstrates, seconds=seconds)
        with console.status("ending the processes, the recorder last …"):
            processes.close()
        if RECORDER in processes.killed:
            console.print(_NOT_WRITTEN, style="bold red", soft_wrap=True)
        if reason := processes.messages_lost:
            console.print(
                f"{folder / MESSAGES_NAME}: not written to its end ({reason})", style="yellow", soft_wrap=True
            )
        return failed


def _tell_said(lines: list[str]) -> None:
    """Print the first warning of the processes, such as no real-time scheduling, and where the others are."""
    if lines:
        more = f" ({len(lines) - 1} more in messages.txt of the run's folder)" if len(lines) > 1 else ""
        console.print(f"{lines[0]}{more}", style="yellow", soft_wrap=True)


def _shown_at(port: int) -> int:
    """Return the port on which Foxglove finds the drive, and print its address."""
    chosen = free_port(LOCAL, port, of="the live log")
    console.print(f"live: open ws://{LOCAL}:{chosen} in Foxglove", soft_wrap=True)
    return chosen


def _report(folder: FilePath, remembers: FilePath | None) -> None:
    """Print the figures and write the report; keep the steerings beside a configuration, also where no report is."""
    from drawbar.cli.calibrate import remember
    from drawbar.errors import StorageError
    from drawbar.recording.log import LOG_NAME

    if not (folder / LOG_NAME).exists():
        raise StorageError(_NOT_THERE.format(folder=folder))
    try:
        show_and_write(folder / LOG_NAME, folder)
    finally:
        if remembers is not None:
            remember(remembers, folder / LOG_NAME)


def _drive(processes: "DriveProcesses", interrupts: "Interrupts", *, demonstrates: bool, seconds: float) -> bool:
    """Show the drive until it is over; return whether it failed."""
    from drawbar.cli.interrupts import leave_a_terminal_that_is_gone
    from drawbar.driving.operator.front_end import FrontEnd, Keyboard
    from drawbar.driving.operator.terminal import Terminal
    from drawbar.messages import SupervisorState

    front, clock = FrontEnd(processes, demonstrates=demonstrates), processes.options.clock
    end = clock() + (seconds or float("inf"))
    try:
        with Terminal(console, processes, front) as terminal, Keyboard() as keyboard:
            while clock() < end and not (demonstrates and front.is_over):
                front.wait(0.05)
                interrupts.raise_pending()
                keys = keyboard.pressed()
                for key in keys:
                    front.press(key)
                if "q" in keys:
                    break
                if keyboard.is_gone:
                    leave_a_terminal_that_is_gone()
                    break
                terminal.show()
                if not terminal.tell_losses():
                    return True
    except KeyboardInterrupt:
        console.print("interrupted: the gate releases the steering")
    except OSError:
        if not leave_a_terminal_that_is_gone():  # if it is, it was written to before its signal arrived
            raise
    finally:
        front.close()
    return front.state is not None and front.state.state in (SupervisorState.FAULT, SupervisorState.ESTOP)


def _new_folder(chosen: FilePath | None, config: "Configuration") -> FilePath:
    """Return a new folder with config.toml in it."""
    from drawbar.errors import DrawbarError

    folder = chosen or FilePath("runs") / time.strftime(f"{config.name}-drive-%Y%m%d-%H%M%S")
    try:
        str(folder).encode()  # as the drive's processes are told it
        folder.mkdir(parents=True)
        with _removed_unless_done(folder):
            (folder / CONFIGURATION_NAME).write_text(config.to_toml(), "utf-8")
    except UnicodeEncodeError as error:
        raise DrawbarError(f"{str(folder)!r} is no name in UTF-8; choose another --out folder") from error
    except FileExistsError as error:
        raise DrawbarError(f"{folder} is there already; choose another --out folder") from error
    except OSError as error:
        raise DrawbarError(f"{folder}: cannot be written ({error.strerror}); choose another --out folder") from error
    return folder


@contextmanager
def _removed_unless_done(folder: FilePath) -> Iterator[None]:
    """Remove a new folder again where what is done here fails: nothing has been driven."""
    try:
        yield
    except BaseException:
        rmtree(folder, ignore_errors=True)
        raise
