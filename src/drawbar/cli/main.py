"""The command line: `drawbar run` drives a path in simulation, other commands measure, compare, tune and explain."""

import sys
from json import dumps
from pathlib import Path as FilePath
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from drawbar.config import Configuration, load_configuration, shipped_names
from drawbar.errors import DrawbarError
from drawbar.export.targets import TARGETS, find_target
from drawbar.recording.header import deviation_note
from drawbar.recording.recorder import Recorder
from drawbar.report.console import RunProgress, summary
from drawbar.report.folder import LOG_NAME, write_report
from drawbar.simulation import Simulation

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
    with console.status("compiling the control step (the first time only) …"):
        simulation = Simulation(config, seed)
    if simulation.drivable:
        console.print(deviation_note(config, simulation.drivable))
    folder = _new_folder(out, config, seed)
    log = Recorder(folder / LOG_NAME, simulation.header())
    stopped: DrawbarError | KeyboardInterrupt | None = None
    try:
        with simulation, log as recorder, RunProgress(console, simulation.path.length) as live:
            for record in simulation.steps():
                recorder.write(record)
                live.show(record)
    except (DrawbarError, KeyboardInterrupt) as error:
        stopped = error
    console.print(summary(write_report(folder)))
    console.print(f"\n{folder / 'report.html'}", soft_wrap=True)
    if stopped is not None:
        raise SystemExit(130 if isinstance(stopped, KeyboardInterrupt) else 1)


@app.command()
def tube(
    configuration: Annotated[
        str,
        typer.Argument(metavar="CONFIG", help=f"TOML file or shipped name: {', '.join(shipped_names())}"),
    ] = "articulated",
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="change one value, e.g. tube.nominal=propagated"),
    ] = None,
    logs: Annotated[
        list[FilePath] | None,
        typer.Option("--from-log", metavar="RUN.mcap", help="hold a recorded run against the declared bounds"),
    ] = None,
    out: Annotated[FilePath | None, typer.Option(help="folder for the pictures; default: runs/NAME-tube")] = None,
) -> None:
    """Compute the invariant sets of both bodies and what they leave of every bound."""
    from drawbar.report.tube.command import show_tubes  # what it draws with is of no use elsewhere

    config = load_configuration(configuration, changes or [])
    if not show_tubes(console, config, out or FilePath("runs") / f"{config.name}-tube", logs or []):
        raise SystemExit(1)


@app.command()
def export(
    configuration: Annotated[
        str,
        typer.Argument(metavar="CONFIG", help=f"TOML file or shipped name: {', '.join(shipped_names())}"),
    ],
    out: Annotated[FilePath, typer.Option(help="folder for the library")],
    targets: Annotated[
        list[str] | None,
        typer.Option("--target", metavar="TARGET", help=f"build for {', '.join(target.name for target in TARGETS)}"),
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="change one value, e.g. controller.horizon=10"),
    ] = None,
) -> None:
    """Write the controller as a C library that needs neither Python nor an operating system."""
    from drawbar.export.export import export_library  # no other command needs it

    machines = [find_target(name) for name in targets or []]
    config = load_configuration(configuration, changes or [])
    with console.status("writing and building the library …"):
        export_library(config, out, machines)
    console.print(out / "README.md", soft_wrap=True)


@app.command()
def bench(
    json: Annotated[FilePath | None, typer.Option(help="also write the figures to this file")] = None,
) -> None:
    """Measure the solvers: phases, floor, growth, and the route through CasADi and DAQP."""
    from drawbar.benchmark.bench import run_benchmark  # its parts take a while to load

    run_benchmark(console, json)


@app.command()
def experiment(
    name: Annotated[str, typer.Argument(metavar="NAME", help="folder in experiments/, or its path; all: every one")],
    seeds: Annotated[int | None, typer.Option(min=1, help="runs of each case; default: as the experiment says")] = None,
    jobs: Annotated[int | None, typer.Option(min=1, help="processes on this machine; default: one per core")] = None,
    cluster: Annotated[str, typer.Option(metavar="ADDRESS", help="of a running Dask scheduler to use instead")] = "",
) -> None:
    """Drive every case of an experiment with many seeds, and write its tables and figures into its folder."""
    from drawbar.experiment.extras import require_extras

    require_extras()
    from drawbar.experiment.command import run_experiments  # Dask and matplotlib, that no other command needs

    _one_cluster(jobs, cluster)
    try:
        met = run_experiments(console, name, seeds=seeds, jobs=jobs, address=cluster)
    except KeyboardInterrupt:
        console.print("\ninterrupted; the same command goes on from the runs that are finished")
        raise SystemExit(130) from None
    raise SystemExit(0 if met else 1)


@app.command()
def tune(
    configuration: Annotated[
        str,
        typer.Argument(metavar="CONFIG", help=f"TOML file or shipped name: {', '.join(shipped_names())}"),
    ],
    more: Annotated[list[str] | None, typer.Argument(metavar="[KEY=LOW..HIGH ...]", show_default=False)] = None,
    parameters: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=LOW..HIGH", help="what is searched, e.g. guidance.look_ahead=0.4..3.0; :log behind it"
        ),
    ] = None,
    trials: Annotated[int, typer.Option(min=1, help="in all; the configuration's own values are the first")] = 64,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="change one value, e.g. tuning.seeds=10"),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the search")] = 0,
    jobs: Annotated[int | None, typer.Option(min=1, help="processes on this machine; default: one per core")] = None,
    cluster: Annotated[str, typer.Option(metavar="ADDRESS", help="of a running Dask scheduler to use instead")] = "",
    out: Annotated[FilePath | None, typer.Option(help="folder for the results; default: runs/NAME-tune")] = None,
) -> None:
    """Search weights or look-ahead for the least error and the least steering; the same command goes on."""
    from drawbar.experiment.extras import require_extras

    require_extras()
    from drawbar.experiment.tuning.command import Budget, tune  # Dask, Optuna and matplotlib
    from drawbar.experiment.tuning.parameters import read_space

    _one_cluster(jobs, cluster)
    space = read_space(configuration, changes or [], [*(parameters or []), *(more or [])])
    folder = out or FilePath("runs") / f"{space.configuration.name}-tune"
    try:
        tune(console, space, folder, Budget(trials=trials, seed=seed, jobs=jobs, address=cluster))
    except KeyboardInterrupt:
        console.print("\ninterrupted; the same command goes on from the runs that are finished")
        raise SystemExit(130) from None


def _one_cluster(jobs: int | None, cluster: str) -> None:
    if jobs and cluster:
        raise DrawbarError(
            f"--jobs {jobs} and --cluster {cluster}: a running cluster has its own workers; leave one out."
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


def main() -> None:
    """Run the command line; every expected error is one message and exit code 2."""
    try:
        app()
    except DrawbarError as error:
        message = Text.assemble(("error:", "bold red"), f" {error}")
        Console(stderr=True, highlight=False).print(message, soft_wrap=True)
        sys.exit(2)
