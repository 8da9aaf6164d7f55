"""`drawbar bench`: measure, show, write."""

import importlib.util
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console, Group, RenderableType
from rich.progress import Progress
from rich.text import Text

from drawbar.benchmark.closed_loop import probed_runs, whole_run
from drawbar.benchmark.figures import machine, microseconds, one_core, rows
from drawbar.errors import DrawbarError
from drawbar.terminal import FittedTable

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
    one_core()
    with Progress(console=console, transient=True) as progress:
        figures = measure(progress, steps=STEPS)
    console.print(solver_table(figures["rows"]))
    console.print(growth_table(figures["rows"]))
    _print_rest(console, figures)
    if json_path is not None:
        try:
            json_path.write_text(json.dumps(figures, indent=2), "utf-8")
        except OSError as error:
            raise DrawbarError(
                f"{json_path}: cannot be written ({error.strerror}); choose another --json file."
            ) from error


def measure(progress: Progress, *, steps: int) -> dict[str, Any]:
    """Return all figures; see the keys."""
    with_other_route = importlib.util.find_spec("daqp") is not None
    task = progress.add_task("closed loops", total=len(HORIZONS) + 1)
    table: list[dict[str, Any]] = []
    for name, horizons in HORIZONS.items():
        first, *longer = probed_runs(name, horizons, steps, with_other_route=with_other_route)
        table += [row for probe in sum(longer, first) for row in rows(probe)]
        progress.advance(task)
    run = whole_run("articulated")
    progress.advance(task)
    return {
        "rows": table,
        "machine": machine(),
        "python_us": microseconds(run.python),
        "control_step_us": microseconds(run.latency),
        "control_step_preparation_us": microseconds(run.preparation),
        "real_time_factor": run.real_time_factor,
        "casadi_daqp": "measured" if with_other_route else "left out: pip install daqp brings it",
    }


def solver_table(rows: list[dict[str, Any]]) -> RenderableType:
    """Return the table of all problems at the base horizon."""
    shown = []
    for row in rows:
        if row["stages"] == STAGES:
            total, floor = row["total_us"], row["floor_us"]
            medians = (row["prepare_us"], row["feedback_us"], *total.values(), floor)
            share = f"{row['bounded_share']:.0%}" if "bounded_share" in row else ""
            numbers = (f"{value:.2f}" if value < 10.0 else f"{value:.0f}" for value in medians)
            name = row["problem"] if row["route"] == "drawbar" else f"  {row['route']}"
            shown.append((name, [*numbers, f"{total['median'] / floor:.2f}", share]))
    columns = ("prep.", "feedb.", "total", "99 %", "max", "floor", "ratio", "bounds")
    return _table(f"one sample, N = {STAGES}, µs, medians unless said", "problem and route", columns, shown)


def _table(title: str, first: str, columns: Sequence[str], rows: list[tuple[str, list[str]]]) -> RenderableType:
    headings = [(name, "") for name in columns]
    return Group(Text(title, "bold"), FittedTable(first, headings, rows, title_width=len(first), column_width=4))


def growth_table(rows: list[dict[str, Any]]) -> RenderableType:
    """Return the medians over the horizon."""
    shown = []
    for name in dict.fromkeys(row["problem"] for row in rows if row["stages"] == GROWTH[-1]):
        own = [row for row in rows if row["problem"] == name and row["route"] == "drawbar"]
        medians = [row["total_us"]["median"] for row in own]
        cells = (f"{row['total_us']['median']:.2f} ({row['bounded_share']:.0%})" for row in own)
        shown.append((name, [*cells, f"{medians[-1] / medians[0]:.1f}"]))
    columns = (*(f"N = {stages}" for stages in (STAGES, *GROWTH)), f"{GROWTH[-1]} / {STAGES}")
    title = "growth with the horizon, median total, µs; in brackets: steps with bounds active"
    return _table(title, "problem", columns, shown)


def _print_rest(console: Console, figures: dict[str, Any]) -> None:
    console.print(f"measurement to command     {_three(figures['control_step_us'])} µs (median / 99 % / max)")
    console.print(f"of it Python's             {_three(figures['python_us'])} µs")
    console.print(f"preparation after it       {_three(figures['control_step_preparation_us'])} µs")
    console.print(f"real-time factor           {figures['real_time_factor']:.0f}, simulation included")
    if figures["casadi_daqp"] != "measured":
        console.print(f"casadi-daqp                {figures['casadi_daqp']}", markup=False)


def _three(figure: dict[str, float]) -> str:
    return f"{figure['median']:.2f} / {figure['p99']:.2f} / {figure['max']:.2f}"
