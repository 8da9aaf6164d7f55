"""Whether what was found by searching is better than what is shipped: error and steering, seed by seed."""

import math
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

OBJECTIVES = ("error", "steering")
SHIPPED = ("paper", "articulated")


def figures(result: Result) -> dict[str, float]:
    """Return the two objectives of `drawbar tune`, each the mean of both bodies: cm and °/s."""
    error, rate = result.metrics.error_m, result.metrics.steering_rate_mean_rad_s
    return {
        "error": 50.0 * (error.tractor[ALL].mean + error.trailer[ALL].mean),
        "steering": 0.5 * math.degrees(rate.tractor + rate.trailer),
    }


def report(campaign: Campaign) -> Iterator[Part]:
    """Yield the table of both objectives, and the paper's set in a picture."""
    yield Table(
        name="objectives",
        caption="Mean distance from the path, cm, and mean steering rate, °/s, each the mean of both bodies, with the "
        "95 % interval over the seeds; *less shipped*: the same less that of `paper` or `articulated`, seed by seed.",
        header=["case", "finished", "error", "less shipped", "steering", "less shipped"],
        rows=[_row(campaign, case) for case in campaign.experiment.settings.cases],
    )
    yield Picture(
        name="look-ahead",
        caption="The paper's set with other look-aheads (in m, beside each point): mean over the seeds with its 95 % "
        "interval.",
        draw=lambda figure: _draw(figure, campaign),
    )


def _row(campaign: Campaign, case: Case) -> list[str]:
    cells = [case.name, campaign.finished(case.name)]
    for objective in OBJECTIVES:
        own = case.name in SHIPPED
        cells += [
            campaign.statistic(case.name, objective).text(2),
            "" if own else _less_shipped(campaign, case, objective).text(2),
        ]
    return cells


def _less_shipped(campaign: Campaign, case: Case, objective: str) -> Statistic:
    shipped = campaign.values(case.configuration, objective)
    return Statistic.of(list(np.subtract(campaign.values(case.name, objective), shipped)))


def _draw(figure: Figure, campaign: Campaign) -> None:
    axes = figure.subplots()
    for case in campaign.experiment.settings.cases:
        if "paper" in (case.name, case.configuration):
            error, steering = (campaign.statistic(case.name, objective) for objective in OBJECTIVES)
            own = case.name in SHIPPED
            axes.errorbar(
                error.mean,
                steering.mean,
                xerr=error.half_width,
                yerr=steering.half_width,
                marker="D" if own else "o",
                color=TRAILER if own else TRACTOR,
            )
            label = "1.6, the paper's own" if own else case.name.removeprefix("look-ahead ")
            axes.annotate(label, (error.mean, steering.mean), xytext=(6, 6), textcoords="offset points")
    axes.set(xlabel="error, cm", ylabel="steering, °/s")
    axes.margins(x=0.12)
