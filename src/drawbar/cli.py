"""The command line: `drawbar run` drives a path in simulation, `drawbar bench` measures the solvers."""

import sys
from datetime import UTC, datetime
from json import dumps
from pathlib import Path as FilePath
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from drawbar.autopilot.build import build_autopilot, build_machine, build_path
from drawbar.autopilot.log import PathTable, RecordedPoints, RunHeader
from drawbar.autopilot.recorder import Recorder
from drawbar.autopilot.run import drive
from drawbar.config import Configuration, load_configuration, shipped_names
from drawbar.errors import DrawbarError
from drawbar.guidance.path import Path
from drawbar.guidance.smoothing import DrivablePath
from drawbar.report.console import RunProgress, summary
from drawbar.report.folder import LOG_NAME, write_report

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="An autopilot that keeps a tractor and its trailer on the line.",
)
console = Console(highlight=False, markup=False)  # names of files and lines may hold brackets


@app.command()
def run(
    configuration: Annotated[
        str,
        typer.Argument(metavar="CONFIG", help=f"TOML file or shipped name: {', '.join(shipped_names())}"),
    ] = "articulated",
    path: Annotated[
        str,
        typer.Option(help="recorded line: AgOpenGPS field folder, CSV (x,y) or GeoJSON; default: figure-eights"),
    ] = "",
    track: Annotated[str, typer.Option(help="name of the line, where the file holds several")] = "",
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="change one value, e.g. vehicle.wheelbase=1.5"),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="of all randomness in the simulated machine")] = 0,
    out: Annotated[FilePath | None, typer.Option(help="folder for the results; default: a new one in runs/")] = None,
) -> None:
    """Drive a whole run in simulation and report on it."""
    # a JSON string is a TOML string
    given = (("path.file", path), ("path.track", track))
    settings = [f"{key}={dumps(text, ensure_ascii=False)}" for key, text in given if text]
    config = load_configuration(configuration, [*settings, *(changes or [])])
    line, drivable = build_path(config)
    if drivable:
        console.print(_deviation(drivable, config))
    with console.status("compiling the solvers (the first time only) …"):
        autopilot = build_autopilot(config, line, build_machine(config, line, seed))
    folder = _new_folder(out, config, seed)
    log = Recorder(folder / LOG_NAME, _header(config, line, drivable, seed))
    stopped: DrawbarError | KeyboardInterrupt | None = None
    try:
        with log as recorder, RunProgress(console, line.length) as live:
            for record in drive(autopilot, time_limit=60.0 + 3.0 * line.length / config.speed):
                recorder.write(record)
                live.show(record)
    except (DrawbarError, KeyboardInterrupt) as error:
        stopped = error
    console.print(summary(write_report(folder)))
    console.print(f"\n{folder / 'report.html'}", soft_wrap=True)
    if stopped is not None:
        raise SystemExit(130 if isinstance(stopped, KeyboardInterrupt) else 1)


@app.command()
def bench(
    json: Annotated[FilePath | None, typer.Option(help="also write the figures to this file")] = None,
) -> None:
    """Measure the solvers: phases, floor, growth, and the route through CasADi and DAQP."""
    from drawbar.benchmark.bench import run_benchmark  # its parts take a while to load

    run_benchmark(console, json)


def _deviation(drivable: DrivablePath, config: Configuration) -> str:
    """Return how far a recorded line's points are from the path that will be driven."""
    worst, limit = int(drivable.deviations.argmax()), config.guidance.path_tolerance
    return (
        f"made drivable: at most {drivable.deviations[worst]:.2f} m off, at recorded point {worst + 1} of "
        f"{len(drivable.deviations)} (limit {limit:.2f} m)"
    )


def _new_folder(chosen: FilePath | None, config: Configuration, seed: int) -> FilePath:
    """Return the folder for the results with config.toml in it; unnamed ones never overwrite each other."""
    name = f"{config.name}-seed{seed}"
    folder = chosen or FilePath("runs") / name
    number = 1
    while chosen is None and folder.exists():
        number += 1
        folder = FilePath("runs") / f"{name}-{number}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "config.toml").write_text(config.to_toml(), "utf-8")
    except OSError as error:
        raise DrawbarError(f"{folder}: cannot be written ({error.strerror}); choose another --out folder.") from error
    return folder


def _header(config: Configuration, path: Path, drivable: DrivablePath | None, seed: int) -> RunHeader:
    return RunHeader(
        configuration_name=config.name,
        configuration=config.to_toml(),
        seed=seed,
        started=datetime.now(UTC),
        vehicle=config.vehicle,
        path_name=config.path.track or config.path.file or "figure-eights",
        path_note=_deviation(drivable, config) if drivable else "",
        path=PathTable.of(path),
        recorded=RecordedPoints.of(drivable.recorded, drivable.deviations) if drivable else None,
        estimate_bounds=config.estimator.bounds_by_estimate(),
    )


def main() -> None:
    """Run the command line; every expected error is one message and exit code 2."""
    try:
        app()
    except DrawbarError as error:
        message = Text.assemble(("error:", "bold red"), f" {error}")
        Console(stderr=True, highlight=False).print(message, soft_wrap=True)
        sys.exit(2)
