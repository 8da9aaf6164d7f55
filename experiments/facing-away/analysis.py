"""Of how many poses that face away from the path there is no way onto it, and how the others get there."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from drawbar.experiment.elements import Element, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result
from drawbar.vehicle.parameters import BODIES

NEAR = 0.15
"""distance from the path under which both bodies must stay to count as on it, m"""
ON_THE_PATH = "on the path after"


def figures(result: Result) -> dict[str, float]:
    """Return whether there is no way, 0 or 100 %, whether it is lost later, and after how many s both bodies are back.

    A run that finds no way ends with its first sample.
    """
    time, metrics = result.columns["measurement.time"], result.metrics
    refused = not metrics.finished and len(time) == 1
    return {
        "without a way": 100.0 * refused,
        "lost later": 100.0 * (not metrics.finished and not refused),
        ON_THE_PATH: _back(result) if metrics.finished else math.nan,
    }


def _back(result: Result) -> float:
    """Return the time from which on both bodies stay near the path, s; NaN where they do not."""
    time = result.columns["measurement.time"]
    errors = np.abs([result.columns[f"error.{body}"] for body in BODIES]).max(axis=0)
    away = np.flatnonzero(~(errors <= NEAR))
    after = int(away[-1]) + 1 if away.size else 0
    return float(time[after]) if after < len(time) else math.nan


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the table."""
    yield Table(
        name="facing-away",
        caption=f"Share of poses for which there is no way onto the path, and of those given up later, mean ± 95 % "
        f"interval; time until both bodies stay within {100.0 * NEAR:.0f} cm of the path, of all that come there.",
        header=["poses", "number", "without a way, %", "lost later, %", "median, s", "95 %, s"],
        rows=[_row(measured, case) for case in measured.cases],
    )


def _row(measured: MeasuredExperiment, case: str) -> list[str]:
    shares = [measured.statistic(case, name).text() for name in ("without a way", "lost later")]
    return [case, str(measured.seeds), *shares, *_quantiles(measured.values(case, ON_THE_PATH))]


def _quantiles(times: Sequence[float]) -> list[str]:
    there = [time for time in times if not math.isnan(time)]
    return [f"{np.percentile(there, percent):.0f}" if there else "–" for percent in (50.0, 95.0)]
