"""Console report: the figures of the run that `drawbar run` shows in a terminal at the end."""

from collections.abc import Iterable

from rich.console import Group, RenderableType
from rich.text import Text

from drawbar.report.masts import doubt_text
from drawbar.report.metrics import Metrics
from drawbar.report.positions import position_texts
from drawbar.report.shadow import ShadowMetrics
from drawbar.report.tables import (
    ERROR_COLUMNS,
    TIME_COLUMNS,
    Row,
    body_rows,
    error_name,
    error_rows,
    number,
    origin,
    refusal_rows,
    shadow_texts,
    time_rows,
)
from drawbar.report.two_antennas import yaw_text
from drawbar.terminal import FittedTable


def _table(title: str, columns: Iterable[tuple[str, str]], rows: list[Row]) -> FittedTable:
    return FittedTable(title, list(columns), rows, title_width=19)


def _shadow_lines(shadow: ShadowMetrics) -> list[str]:
    """Return when a drive at which drawbar only looked on could have been engaged, and what stood against it."""
    engaging, *others = shadow_texts(shadow)
    against = [f"- {lasted}: {cells[0]}" for lasted, cells in refusal_rows(shadow)]
    return ["", "drawbar only looked on:", engaging, *against, *others]


def summary(metrics: Metrics) -> RenderableType:
    """Return the figures of a run for the console, as wide as that is."""
    colours = {"tractor": "blue", "trailer": "yellow"}
    error_columns = [(f"{body}\n{name}", colour) for body, colour in colours.items() for name in ERROR_COLUMNS]
    ending = Text("finished", "green") if metrics.finished else Text(f"stopped: {metrics.outcome}", "bold red")
    distance, duration = number(metrics.length_m, 1, " m"), number(metrics.duration_s, 1, " s")
    pace = "" if metrics.error_estimated else f", {number(metrics.real_time_factor, 0, '× real time')}"
    doubts = (
        doubt_text(metrics.mast_doubt_m.tractor, metrics.mast_doubt_m.trailer),
        yaw_text(metrics.yaw_difference_rad),
        *position_texts(metrics.residual_m, metrics.rejected_share, metrics.antennas_aside_m),
    )
    shown: list[RenderableType] = [
        "",
        Text.assemble(f"{origin(metrics, ', ')}: ", ending),
        f"{distance} in {duration}{pace}",
        f"solver failures: {metrics.solver_failures}, commands limited: {metrics.limited_commands}, "
        f"refused: {metrics.refused_commands}",
        *(_shadow_lines(metrics.shadow) if metrics.shadow is not None else []),
        *(Text(doubt, "bold yellow") for doubt in doubts if doubt),
        *(Text(f"log: {loss}", "bold yellow") for loss in metrics.losses),
    ]
    if not metrics.duration_s:  # no figure is known
        return Group(*shown)
    tables: list[tuple[str, Iterable[tuple[str, str]], list[Row]]] = [
        (f"{error_name(metrics)}, cm", error_columns, error_rows(metrics)),
        ("", colours.items(), body_rows(metrics)),
        ("solver, µs", [(name, "") for name in TIME_COLUMNS], time_rows(metrics)),
    ]
    for title, columns, rows in tables:
        if rows:
            shown += ["", _table(title, columns, rows)]
    return Group(*shown)
