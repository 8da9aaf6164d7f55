"""What `drawbar run` shows in a terminal: the run as it goes, and its figures at the end."""

import time
from collections.abc import Iterable

from rich.console import Console, Group, RenderableType
from rich.text import Text

from drawbar.report.live import LiveLine
from drawbar.report.masts import doubt_text
from drawbar.report.metrics import Metrics
from drawbar.report.tables import (
    ERROR_COLUMNS,
    TIME_COLUMNS,
    Row,
    body_rows,
    error_name,
    error_rows,
    number,
    time_rows,
)
from drawbar.signals import StepRecord
from drawbar.terminal import FittedTable


class RunProgress(LiveLine):
    """One line that follows the run."""

    def __init__(self, console: Console, length: float) -> None:
        """Show progress on the console along a path of the given length, m."""
        super().__init__(console)
        self._length = length
        self._start = time.perf_counter()

    def show(self, record: StepRecord) -> None:
        """Draw the state of the run after a step, if it is time to."""
        if self.due():
            self.draw(progress_line(record, self._length, time.perf_counter() - self._start))


def progress_line(record: StepRecord, length: float, elapsed: float) -> Text:
    """Say how far the run is after `elapsed` s of wall-clock time, at most 80 columns wide."""
    driven, now = record.reference.tractor.progress, record.measurement.time
    share = min(max(driven / length, 0.0), 1.0)
    factor = f"{now / elapsed:5.0f}×" if elapsed > 0.0 else "     –"
    tractor, trailer = (
        100.0 * record.reference.tractor.lateral_error,
        100.0 * record.reference.trailer.lateral_error,
    )
    return Text.assemble(
        (f"{share:4.0%} ", "bold"),
        f"{driven:z6.0f} of {length:.0f} m  {now:6.0f} s {factor}  ",
        (f"tractor {tractor:+z6.1f} ", "blue"),
        (f"trailer {trailer:+z6.1f}", "yellow"),
        " cm",
    )


def _table(title: str, columns: Iterable[tuple[str, str]], rows: list[Row]) -> FittedTable:
    return FittedTable(title, list(columns), rows, title_width=19)


def summary(metrics: Metrics) -> RenderableType:
    """Return the figures of a run for the console, as wide as that is."""
    colours = {"tractor": "blue", "trailer": "yellow"}
    error_columns = [(f"{body}\n{name}", colour) for body, colour in colours.items() for name in ERROR_COLUMNS]
    ending = Text("finished", "green") if metrics.finished else Text(f"stopped: {metrics.outcome}", "bold red")
    distance, duration = number(metrics.length_m, 1, " m"), number(metrics.duration_s, 1, " s")
    pace = number(metrics.real_time_factor, 0, "× real time")
    doubt = doubt_text(metrics.mast_doubt_m.tractor, metrics.mast_doubt_m.trailer)
    return Group(
        "",
        Text.assemble(f"{metrics.config}, seed {metrics.seed}: ", ending),
        f"{distance} in {duration}, {pace}",
        f"solver failures: {metrics.solver_failures}, commands limited: {metrics.limited_commands}, "
        f"refused: {metrics.refused_commands}",
        *([Text(doubt, "bold yellow")] if doubt else []),
        "",
        _table(f"{error_name(metrics)}, cm", error_columns, error_rows(metrics)),
        "",
        _table("", colours.items(), body_rows(metrics)),
        "",
        _table("solver, µs", [(name, "") for name in TIME_COLUMNS], time_rows(metrics)),
    )
