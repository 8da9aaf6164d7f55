"""`drawbar bench`: measure, show, write."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

from drawbar.benchmark.closed_loop import WholeRun, probed_runs, whole_run
from drawbar.benchmark.figures import machine, microseconds, one_core, race_rows, row
from drawbar.benchmark.peers.race import PEERS
from drawbar.benchmark.start_up import start_up
from drawbar.benchmark.tables import bounds_table, growth_table, race_growth_table, race_table, solver_table
from drawbar.errors import DrawbarError

STAGES = 15
GROWTH = (30, 60, 120)
STEPS = 1000
HORIZONS = {
    "paper": (STAGES, *GROWTH),
    "paper-centralised": (STAGES,),
    "articulated": (STAGES,),
    "articulated-centralised": (STAGES,),
}


def run_benchmark(console: Console, json_path: Path | None = None) -> None:
    """Measure every solver in closed loop on one core, print the tables and write the figures where asked.

    Args:
        console: where to print.
        json_path: file for all figures, or None.

    Raises:
        DrawbarError: the file cannot be written.
        CompilerError: a solver could not be compiled.
    """
    if json_path is not None:
        _demand_writable(json_path)
    one_core()
    with Progress(console=console, transient=True) as progress:
        figures = measure(progress, steps=STEPS)
    show(console, figures)
    if json_path is not None:
        with _writing(json_path):
            json_path.write_text(json.dumps(figures, indent=2), "utf-8")


@contextmanager
def _writing(file: Path) -> Iterator[None]:
    """Turn what keeps a file from being written into an error that names it."""
    try:
        yield
    except OSError as error:
        raise DrawbarError(f"{file}: cannot be written ({error.strerror}); choose another --json file.") from error


def _demand_writable(file: Path) -> None:
    """Raise DrawbarError where a file cannot be written; one that is not there is not there afterwards either."""
    there = file.exists()
    with _writing(file):
        file.open("ab").close()
        if not there:
            file.unlink()


def measure(progress: Progress, *, steps: int) -> dict[str, Any]:
    """Return all figures; see the keys."""
    task = progress.add_task("closed loops", total=len(HORIZONS) + 1)
    probes = []
    for name, horizons in HORIZONS.items():
        first, *longer = probed_runs(name, horizons, steps, with_peers=True)
        probes += sum(longer, first)
        progress.advance(task)
    run = whole_run("articulated")
    progress.advance(task)
    return {
        "rows": [row(probe) for probe in probes],
        "peers": [each for probe in probes for each in race_rows(probe)],
        "peers_missing": {name: why for probe in probes if probe.race for name, why in probe.race.missing.items()},
        "machine": machine(),
        "start_up": start_up(),
        **_step_figures(run),
    }


def _step_figures(run: WholeRun) -> dict[str, Any]:
    by_bounds: dict[bool, list[float]] = {False: [], True: []}
    for time, bounded in zip(run.in_c.feedback, run.bounded, strict=True):
        by_bounds[bounded].append(time)
    return {
        "c_step_us": microseconds(run.in_c.feedback),
        "c_step_free_us": microseconds(by_bounds[False]) if by_bounds[False] else None,
        "c_step_active_us": microseconds(by_bounds[True]) if by_bounds[True] else None,
        "c_step_preparation_us": microseconds(run.in_c.preparation),
        "control_step_us": microseconds(run.latency),
        "python_us": microseconds(run.python),
        "real_time_factor": run.real_time_factor,
        "real_time_factor_logged": run.real_time_factor_logged,
    }


def show(console: Console, figures: dict[str, Any]) -> None:
    """Print all tables."""
    rows, peers = figures["rows"], figures["peers"]
    for table in (solver_table(rows, STAGES), bounds_table(rows, STAGES), growth_table(rows)):
        console.print(table, "")
    console.print(race_table(peers, STAGES), "", race_growth_table(peers), "")
    console.print("drawbar: factorisation, solution and check, from the linearised problem", markup=False)
    for peer in PEERS:
        why = figures["peers_missing"].get(peer.name)
        console.print(f"{peer.name}: {f'left out: {why}' if why else peer.timed}", markup=False)
    console.print("\none step of the product, articulated, µs (median / mean / 99 % / max)", style="bold")
    lines = {
        "in C, measurement to command": "c_step_us",
        "  no bound active": "c_step_free_us",
        "  bounds active": "c_step_active_us",
        "in C, preparation after it": "c_step_preparation_us",
        "from Python": "control_step_us",
        "  of it Python's": "python_us",
    }
    for text, key in lines.items():
        if figure := figures[key]:
            console.print(f"{text:30}{' / '.join(f'{value:.2f}' for value in figure.values())}", highlight=False)
    alone, logged = (f"{figures[key]:.0f}" for key in ("real_time_factor", "real_time_factor_logged"))
    console.print(f"real-time factor of a whole run, simulation included: {alone}, with its log {logged}")
    start = figures["start_up"]
    waits = {
        "import drawbar, warm": "import",
        "a run's first step, warm": "first_step",
        "a run's first step, solvers to be compiled": "cold_first_step",
    }
    for text, key in waits.items():
        wall, cpu = (start[f"{key}{suffix}"] for suffix in ("_s", "_cpu_s"))
        console.print(f"from a process' start to {text}: {wall:.2f} s, of the processor {cpu:.2f} s", highlight=False)
