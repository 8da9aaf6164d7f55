"""What the controllers ask of the steering, what it does, and how much of it is the ancillary law's."""

import tomllib
from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drawbar.config import Configuration
from drawbar.experiment.elements import Element, Picture, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result
from drawbar.report.style import BODY_COLOURS, GRID, INK, REFERENCE
from drawbar.simulation import build_path

BODIES = tuple(BODY_COLOURS)
REVERSED = ("paper", "paper-ideal")
"""configurations whose trailer's joint goes to the mirror image of its command; it is shown as the command sees it"""
CASES = {"paper": "the paper's set (paper)", "articulated": "the product (articulated)"}
PAPER_SHARES = {"tractor": "< 1", "trailer": "≈ 5"}
"""the paper's ancillary shares, %"""
QUANTITIES = {
    "ancillary share": "ancillary share, %",
    "ancillary size": "ancillary size, %",
    "lag": "actual − commanded, RMS, °",
    "rate": "mean |steering rate|, °/s",
    "clipped": "clipped sums, %",
}
DASHED = (0, (4, 2))
CLOSE_UP = (18.0, 48.0)
"""the first curve from shortly before its start, m along the path"""


def figures(result: Result) -> dict[str, float]:
    """Return shares (%), lag (°) and rate (°/s) of both bodies in one run."""
    return {f"{body} {name}": value for body in BODIES for name, value in _of_body(result, body).items()}


def _of_body(result: Result, body: str) -> dict[str, float]:
    metrics = result.metrics
    command, actual = result.columns[f"{body}_steering.command"], _actual(result, body)
    ancillary = result.columns[f"{body}_steering.ancillary"]
    return {
        "ancillary share": 100.0 * getattr(metrics.ancillary_share, body),
        "ancillary size": 100.0 * float(np.abs(ancillary).sum() / np.abs(command).sum()),
        # a step's truth is from before its command: the last command is what the joint follows by then
        "lag": float(np.degrees(np.sqrt(np.mean((actual[1:] - command[:-1]) ** 2)))),
        "rate": float(np.degrees(getattr(metrics.steering_rate_mean_rad_s, body))),
        "clipped": 100.0 * getattr(metrics.saturated_share, body),
    }


def _actual(result: Result, body: str) -> np.ndarray:
    """Return a body's true steering in the sense of its command, rad."""
    sign = -1.0 if body == "trailer" and result.metrics.config in REVERSED else 1.0
    return sign * result.columns[f"truth.{body}_steering"]


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the table of shares and, of the first run, the steering along the path and in one curve."""
    yield _shares(measured)
    for case, title in CASES.items():
        yield Picture(
            name=f"steering-{case}",
            caption=f"Commanded and actual steering of {title}, seed 0. Dashed: the steering's limits. Shaded: curves.",
            draw=lambda figure, case=case: _draw(figure, measured, case),
            size=(8.0, 4.6),
        )
    yield Picture(
        name="close-up",
        caption="The first curve from near: the actuators follow their commands with a lag of 0.3 s, seed 0.",
        draw=lambda figure: _draw_close_up(figure, measured),
        size=(8.0, 4.6),
    )


def _shares(measured: MeasuredExperiment) -> Table:
    rows = [["the paper", body, PAPER_SHARES[body], *("" for _ in list(QUANTITIES)[1:]), ""] for body in BODIES]
    for case in measured.cases:
        for body in BODIES:
            cells = [measured.statistic(case, f"{body} {name}").text() for name in QUANTITIES]
            rows.append([case, body, *cells, _at_limit(measured, case, body)])
    return Table(
        name="shares",
        caption="Steering over the three figure-eights, mean over the seeds ± 95 % interval. Share: sum of the "
        "ancillary term in the command's direction per sum of |command|; size: sum of its magnitude instead.",
        header=["", "", *QUANTITIES.values(), "command at its limit (1°), %"],
        rows=rows,
    )


def _at_limit(measured: MeasuredExperiment, case: str, body: str) -> str:
    """Return the share of samples whose command is within 1° of the body's steering limit."""
    limit = _limit(measured, case, body)
    commands = np.concatenate([result.columns[f"{body}_steering.command"] for result in measured.runs[case].results])
    return f"{100.0 * np.mean(np.abs(commands) >= limit - np.radians(1.0)):.1f}"


def _configuration(measured: MeasuredExperiment, case: str) -> Configuration:
    return Configuration.model_validate(tomllib.loads(measured.experiment.configurations[case]))


def _limit(measured: MeasuredExperiment, case: str, body: str) -> float:
    limit: float = getattr(_configuration(measured, case).vehicle, f"{body}_steering_limit")
    return limit


def _draw(figure: Figure, measured: MeasuredExperiment, case: str) -> None:
    panels = figure.subplots(2, 1, sharex=True)
    for axes, body in zip(panels, BODIES, strict=True):
        _draw_steering(axes, measured, case, body)
        _shade_curves(axes, measured, case)
        limit = np.degrees(_limit(measured, case, body))
        axes.axhline(limit, color=REFERENCE, ls=DASHED, lw=0.9)
        axes.axhline(-limit, color=REFERENCE, ls=DASHED, lw=0.9)
        axes.set(title=body, ylabel="steering, °", ylim=(-1.15 * limit, 1.15 * limit))
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.0)
    progress = measured.runs[case].results[0].columns["progress.tractor"]
    panels[1].set(xlabel="closest point of the path, m", xlim=(0.0, progress[-1]))


def _draw_close_up(figure: Figure, measured: MeasuredExperiment) -> None:
    panels = figure.subplots(2, len(CASES), sharex=True, sharey="row")
    for row, body in zip(panels, BODIES, strict=True):
        for axes, (case, title) in zip(row, CASES.items(), strict=True):
            _draw_steering(axes, measured, case, body, CLOSE_UP)
            axes.set(title=f"{body}, {title}", xlim=CLOSE_UP)
        row[0].set(ylabel="steering, °")
        row[1].legend(loc="best")
    for axes in panels[1]:
        axes.set(xlabel="closest point of the path, m")


def _draw_steering(
    axes: Axes, measured: MeasuredExperiment, case: str, body: str, span: tuple[float, float] = (-np.inf, np.inf)
) -> None:
    """Draw commanded and actual steering over a span of the path, m."""
    result = measured.runs[case].results[0]
    progress = result.columns[f"progress.{body}"]
    shown = (span[0] <= progress) & (progress <= span[1])
    for values, label, look in (
        (_actual(result, body), "actual", {"color": BODY_COLOURS[body], "lw": 1.4}),
        (result.columns[f"{body}_steering.command"], "commanded", {"color": INK, "lw": 0.6}),
    ):
        axes.plot(progress[shown], np.degrees(values[shown]), label=label, **look)


def _shade_curves(axes: Axes, measured: MeasuredExperiment, case: str) -> None:
    path, _ = build_path(_configuration(measured, case))
    nodes = np.arange(0.0, path.length, 0.25)
    curved = np.array(path.labels(nodes)) != "straight"
    axes.fill_between(nodes, 0.0, 1.0, where=curved, transform=axes.get_xaxis_transform(), color=GRID, lw=0.0)
