"""`drawbar run`: drive a whole run in simulation and report on it."""

from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

import typer

from drawbar.cli.options import ConfigurationName, Track, changing, compiling, configured, console, written
from drawbar.cli.report import show_and_write
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.errors import DrawbarError, StorageError

if TYPE_CHECKING:
    from drawbar.cli.interrupts import Interrupts
    from drawbar.config import Configuration
    from drawbar.simulation import Simulation


def run(
    configuration: ConfigurationName = "articulated",
    path: Annotated[
        str | None,
        typer.Option(help="recorded line: AgOpenGPS field folder, CSV (x,y) or GeoJSON; default: figure-eights"),
    ] = None,
    track: Track = "",
    changes: Annotated[list[str] | None, changing("vehicle.wheelbase=1.5")] = None,
    seed: Annotated[int, typer.Option(min=0, help="of all randomness in the simulated machine")] = 0,
    out: Annotated[
        FilePath | None,
        typer.Option(parser=written, metavar="PATH", help="folder for the results; default: a new one in runs/"),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="overwrite the run that is in the folder")] = False,
) -> None:
    """Drive a whole run in simulation and report on it."""
    from drawbar.cli.interrupts import Interrupts
    from drawbar.recording.log import LOG_NAME
    from drawbar.simulation import Simulation

    config = configured(configuration, path, track, changes or [])
    if out is not None and not force:
        _refuse_a_run_in(out)
    with compiling():
        simulation = Simulation(config, seed)
    folder = _new_folder(out, config, seed, force=force)
    with Interrupts() as interrupts:
        stopped = _drive(simulation, folder, interrupts)
        if isinstance(stopped, StorageError):
            raise stopped
        show_and_write(folder / LOG_NAME, folder)
    if stopped is not None:
        raise SystemExit(130 if isinstance(stopped, KeyboardInterrupt) else 1)


def _drive(
    simulation: "Simulation", folder: FilePath, interrupts: "Interrupts"
) -> DrawbarError | KeyboardInterrupt | None:
    """Drive to the end, the log in the folder; return what ended the run before."""
    from drawbar.recording.header import path_notes
    from drawbar.recording.log import LOG_NAME
    from drawbar.recording.recorder import Recorder
    from drawbar.report.progress import RunProgress

    for note in path_notes(simulation.configuration, simulation.path, simulation.drivable):
        console.print(note)
    log = Recorder(folder / LOG_NAME, simulation.header())
    try:
        with simulation, log as recorder, RunProgress(console, simulation.path.length) as live:
            for record in simulation.steps():
                recorder.write(record)
                live.show(record)
                interrupts.raise_pending()
    except (DrawbarError, KeyboardInterrupt) as error:
        return error
    return None


def _refuse_a_run_in(folder: FilePath) -> None:
    """Raise DrawbarError where a folder holds files that a run would overwrite."""
    from drawbar.recording.log import LOG_NAME
    from drawbar.report.folder import REPORT_NAMES

    if there := [name for name in (CONFIGURATION_NAME, LOG_NAME, *REPORT_NAMES) if (folder / name).exists()]:
        raise _held(folder, there)


def _held(folder: FilePath, there: list[str]) -> DrawbarError:
    """Return the refusal of a folder that holds files of a run."""
    return DrawbarError(
        f"{folder}: holds a run already ({', '.join(there)}); choose another --out folder, or overwrite it "
        f"with --force."
    )


def _new_folder(chosen: FilePath | None, config: "Configuration", seed: int, *, force: bool) -> FilePath:
    """Return the folder for the results with config.toml in it, which only one of several runs at a time can make."""
    from drawbar.recording.log import LOG_NAME
    from drawbar.recording.recorder import demand_not_recorded

    folder = chosen or _unused_folder(f"{config.name}-seed{seed}")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        demand_not_recorded(folder / LOG_NAME)
        with (folder / CONFIGURATION_NAME).open("w" if force else "x", encoding="utf-8") as file:
            file.write(config.to_toml())
    except FileExistsError as error:
        if not folder.is_dir():
            raise StorageError(f"{folder}: is there and is no folder; choose another --out folder.") from error
        raise _held(folder, [CONFIGURATION_NAME]) from error
    except OSError as error:
        raise StorageError(f"{folder}: cannot be written ({error.strerror}); choose another --out folder.") from error
    return folder


def _unused_folder(name: str) -> FilePath:
    """Return a folder in runs/ that is not there yet."""
    folder, number = FilePath("runs") / name, 1
    while folder.exists():
        number += 1
        folder = FilePath("runs") / f"{name}-{number}"
    return folder
