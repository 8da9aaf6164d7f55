"""Whether what was found by searching is better than what is shipped: error, steering and overshoot, seed by seed."""

import math
import re
from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from drawbar.campaign.campaign import Campaign
from drawbar.campaign.experiment import Case
from drawbar.campaign.parts import Part, Picture, Table
from drawbar.campaign.statistics import Statistic
from drawbar.campaign.task import Result
from drawbar.report.metrics import ALL
from drawbar.report.style import TRACTOR, TRAILER

ON, BESIDE = "on the path", "from 2 m beside"
OWN_LOOK_AHEAD = "1.6, the paper's own"
SETTLING = 20.0
"""time at the start in which the path may be crossed to its other side, s"""


def figures(result: Result) -> dict[str, float]:
    """Return the two objectives of `drawbar tune`, each the mean of both bodies, cm and °/s, and the overshoot, cm."""
    error, rate = result.metrics.error_m, result.metrics.steering_rate_mean_rad_s
    early = result.columns["measurement.time"] < SETTLING
    crossed = (-result.columns[f"error.{body}"][early].min() for body in ("tractor", "trailer"))
    return {
        "error": 50.0 * (error.tractor[ALL].mean + error.trailer[ALL].mean),
        "steering": 0.5 * math.degrees(rate.tractor + rate.trailer),
        "overshoot": 100.0 * max(crossed),  # the start is to the left of the path, where errors are positive
    }


def report(campaign: Campaign) -> Iterator[Part]:
    """Yield both objectives as a table, the paper's set as a picture, and what calm weights cost."""
    yield Table(
        name="objectives",
        caption="Mean distance from the path, cm, and mean steering rate, °/s, each the mean of both bodies, with the "
        "95 % interval over the seeds; *less shipped*: less that of `paper` or `articulated`, seed by seed.",
        header=["case", "finished", "error", "less shipped", "steering", "less shipped"],
        rows=[_row(campaign, case) for case in campaign.experiment.settings.cases],
    )
    yield Picture(
        name="look-ahead",
        caption="The paper's set with other look-aheads (m, beside each point), and with other weights too (tuned): "
        "mean over the seeds with its 95 % interval.",
        draw=lambda figure: _draw(figure, campaign),
    )
    calm = [case for case in campaign.experiment.settings.cases if not case.variants]
    yield Table(
        name="overshoot",
        caption="From a start 2 m beside the path: how far the worse body crosses it, cm; 10 are allowed.",
        header=["case", "finished", "overshoot"],
        rows=[
            [case.name, campaign.finished(name), campaign.statistic(name, "overshoot").text()]
            for case in calm
            for name in (f"{case.name}: {BESIDE}",)
        ],
    )


def _row(campaign: Campaign, case: Case) -> list[str]:
    cells = [case.name, campaign.finished(f"{case.name}: {ON}")]
    for objective in ("error", "steering"):
        own = campaign.values(f"{case.name}: {ON}", objective)
        cells.append(Statistic.of(own).text(2))
        shipped = campaign.values(f"{case.configuration}: {ON}", objective) if case.configuration else []
        cells.append(Statistic.of(list(np.subtract(own, shipped))).text(2) if shipped else "")
    return cells


def _draw(figure: Figure, campaign: Campaign) -> None:
    axes = figure.subplots()
    for case in campaign.experiment.settings.cases:
        if "paper" not in (case.name, case.configuration):
            continue
        error, steering = (campaign.statistic(f"{case.name}: {ON}", objective) for objective in ("error", "steering"))
        axes.errorbar(
            error.mean,
            steering.mean,
            xerr=error.half_width,
            yerr=steering.half_width,
            marker="o",
            color=TRACTOR if case.configuration else TRAILER,
        )
        label = re.sub("look-ahead |paper, ", "", case.name) if case.configuration else OWN_LOOK_AHEAD
        axes.annotate(label, (error.mean, steering.mean), xytext=(6, 6), textcoords="offset points")
    axes.set(xlabel="error, cm", ylabel="steering, °/s")
    axes.margins(x=0.12)
