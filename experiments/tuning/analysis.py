"""Whether what was found by searching is better than what is shipped: error, steering, a start beside the path."""

import math
import re
from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from drawbar.experiment.declaration import Case
from drawbar.experiment.elements import Element, Picture, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.statistics import Statistic
from drawbar.experiment.task import Result
from drawbar.report.metrics import ALL
from drawbar.report.style import TRACTOR, TRAILER

ON, BESIDE = "on the path", "from 2 m beside"
OWN_LOOK_AHEAD = "1.6, the paper's own"
NEAR = 0.15
"""distance from the path under which both bodies must stay to count as settled, m"""
SETTLING = 20.0
"""time at the start in which the path may be crossed to its other side, s"""


def figures(result: Result) -> dict[str, float]:
    """Return the two objectives of `drawbar tune`, cm and °/s, the overshoot, cm, and the time until settled, s."""
    error, rate = result.metrics.error_m, result.metrics.steering_rate_mean_rad_s
    time = result.columns["measurement.time"]
    bodies = np.array([result.columns["error.tractor"], result.columns["error.trailer"]])
    away = time[(abs(bodies) > NEAR).any(axis=0)]
    return {
        "error": 50.0 * (error.tractor[ALL].mean + error.trailer[ALL].mean),
        "steering": 0.5 * math.degrees(rate.tractor + rate.trailer),
        # the start is to the left of the path, where errors are positive
        "overshoot": -100.0 * bodies[:, time < SETTLING].min(),
        "settled": away[-1] if away.size else 0.0,
    }


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield both objectives as a table, the paper's set as a picture, and what a start beside the path shows."""
    yield Table(
        name="objectives",
        caption="Mean distance from the path, cm, and mean steering rate, °/s, each the mean of both bodies, with the "
        "95 % interval over the seeds; *less shipped*: less that of `paper` or `articulated`, seed by seed.",
        header=["case", "finished", "error", "less shipped", "steering", "less shipped"],
        rows=[_row(measured, case) for case in measured.experiment.settings.cases],
    )
    yield Picture(
        name="look-ahead",
        caption="The paper's set with other look-aheads (m, beside each point), and with other weights too (tuned): "
        "mean over the seeds with its 95 % interval.",
        draw=lambda figure: _draw(figure, measured),
    )
    starting = [f"{case.name}: {BESIDE}" for case in measured.experiment.settings.cases if not case.variants]
    yield Table(
        name="start",
        caption="From a start 2 m beside the path: how far the worse body crosses it, cm, and when both are within 15 "
        "cm for good, s; 10 cm and 8 s are wanted.",
        header=["case", "finished", "overshoot", "settled"],
        rows=[
            [
                case,
                measured.finished(case),
                *(measured.statistic(case, name).text() for name in ("overshoot", "settled")),
            ]
            for case in starting
        ],
    )


def _row(measured: MeasuredExperiment, case: Case) -> list[str]:
    cells = [case.name, measured.finished(f"{case.name}: {ON}")]
    for objective in ("error", "steering"):
        own = measured.values(f"{case.name}: {ON}", objective)
        cells.append(Statistic.of(own).text(2))
        shipped = measured.values(f"{case.configuration}: {ON}", objective) if case.configuration else []
        cells.append(Statistic.of(list(np.subtract(own, shipped))).text(2) if shipped else "")
    return cells


def _draw(figure: Figure, measured: MeasuredExperiment) -> None:
    axes = figure.subplots()
    for case in measured.experiment.settings.cases:
        if "paper" not in (case.name, case.configuration):
            continue
        error, steering = (measured.statistic(f"{case.name}: {ON}", objective) for objective in ("error", "steering"))
        axes.errorbar(
            error.mean,
            steering.mean,
            xerr=error.half_width,
            yerr=steering.half_width,
            marker="o",
            color=TRACTOR if case.configuration else TRAILER,
        )
        label = re.sub("look-ahead |paper, ", "", case.name) if case.configuration else OWN_LOOK_AHEAD
        above = 6 if case.configuration else -14  # the long label lies below those of its neighbours
        axes.annotate(label, (error.mean, steering.mean), xytext=(6, above), textcoords="offset points")
    axes.set(xlabel="error, cm", ylabel="steering, °/s")
    axes.margins(x=0.12)
