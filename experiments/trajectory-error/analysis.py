"""The paper's error figure and its means by curvature, and whether any comparator beats the product."""

import tomllib
from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from drawbar.config import Configuration
from drawbar.experiment.elements import Element, Picture, Table, Text
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.statistics import Statistic
from drawbar.report.style import BODY_COLOURS, GRID, REFERENCE
from drawbar.simulation import build_path

PRODUCT = "articulated"
CLASSES = ("straight", "0.1", "0.125", "0.15")
TITLES = ("straight", "curve 0.1/m", "curve 0.125/m", "curve 0.15/m")
WHOLE = ("SD", "95 %", "largest")
BODIES = tuple(BODY_COLOURS)
FIELD = {"tractor": (7.95, 59.54, 66.93, 76.86), "trailer": (5.42, 55.51, 64.41, 76.38)}
"""the paper's means in the field, cm, in the order of the classes"""
DASHED = (0, (4, 2))
MARKERS = {"tractor": "o", "trailer": "s"}


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the table of means, who beats the product, and the two figures."""
    yield _means(measured)
    yield Text(text=_who_beats_the_product(measured))
    yield Picture(
        name="error",
        caption="Distance of the points on the ground from the path, seed 0: the paper's set and the product's, at two "
        "scales. Dashed: the paper's means in the field. Shaded: curves.",
        draw=lambda figure: _draw_errors(figure, measured),
        size=(8.0, 5.2),
    )
    yield Picture(
        name="means",
        caption="Mean distance by class of the path, mean over the seeds with its 95 % interval, logarithmic.",
        draw=lambda figure: _draw_means(figure, measured),
        size=(10.0, 0.24 * len(measured.cases) + 1.4),
    )


def _means(measured: MeasuredExperiment) -> Table:
    field = [f"{tractor:.1f} / {trailer:.1f}" for tractor, trailer in zip(*FIELD.values(), strict=True)]
    rows = [["the paper, in the field", "", *field, *("" for _ in WHOLE)]]
    for case in measured.cases:
        cells = [_both(measured, case, label) for label in (*CLASSES, *WHOLE)]
        rows.append([case, measured.finished(case), *cells])
    return Table(
        name="means",
        caption="Distance of the points on the ground from the path at 1 m/s, tractor / trailer, cm: mean by class of "
        "the path, standard deviation of the signed distance, 95 % and largest of a run, each as mean over the seeds "
        "± 95 % interval.",
        header=["", "finished", *TITLES, *WHOLE],
        rows=rows,
    )


def _both(measured: MeasuredExperiment, case: str, label: str) -> str:
    return " / ".join(measured.statistic(case, f"{body} {label}").text() for body in BODIES)


def _who_beats_the_product(measured: MeasuredExperiment) -> str:
    lines = [f"Comparators whose mean is below that of `{PRODUCT}` on both bodies at once:", ""]
    for label, title in zip(CLASSES, TITLES, strict=True):
        better = [_claim(measured, case, label) for case in measured.cases if case != PRODUCT]
        lines.append(f"- {title}: {', '.join(filter(None, better)) or 'none'}")
    explanation = (
        "In brackets: by how many cm, tractor / trailer, over the same seeds; **bold** where the 95 % intervals of "
        "both differences leave out zero. `…-ideal` knows the true state, which no machine does."
    )
    return "\n".join([*lines, "", explanation])


def _claim(measured: MeasuredExperiment, case: str, label: str) -> str:
    """Return the name of a comparator that beats the product on both bodies, with the margins; empty if it does not."""
    margins = [_margin(measured, case, f"{body} {label}") for body in BODIES]
    if not all(margin.mean > 0.0 for margin in margins):
        return ""
    sure = all(margin.mean > margin.half_width for margin in margins)
    text = f"{case} ({' / '.join(margin.text(2) for margin in margins)})"
    return f"**{text}**" if sure else text


def _margin(measured: MeasuredExperiment, case: str, figure: str) -> Statistic:
    """Return by how much a comparator is nearer to the path than the product, seed by seed."""
    pairs = zip(measured.values(PRODUCT, figure), measured.values(case, figure), strict=True)
    return Statistic.of([product - other for product, other in pairs])


def _draw_errors(figure: Figure, measured: MeasuredExperiment) -> None:
    panels = figure.subplots(2, 1, sharex=True)
    cases = {"paper": "the paper's set (paper)", PRODUCT: "the product (articulated)"}
    for axes, (case, title) in zip(panels, cases.items(), strict=True):
        run = measured.runs[case].results[0]
        progress = run.columns["progress.tractor"]
        for body, colour in BODY_COLOURS.items():
            axes.plot(progress, 100.0 * np.abs(run.columns[f"error.{body}"]), color=colour, label=body, lw=0.9)
        axes.set(ylabel="distance, cm", ylim=(0.0, None), xlim=(0.0, progress[-1]))
        axes.set_title(title, pad=14.0)
        _shade_curves(axes, measured, case)
    panels[0].plot([], [], color=REFERENCE, ls=DASHED, lw=0.9, label="the paper's mean in the field")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=3)
    panels[1].set_xlabel("closest point of the path to the tractor, m")


def _shade_curves(axes: Axes, measured: MeasuredExperiment, case: str) -> None:
    """Mark the curves, and draw the paper's means beside its set."""
    configuration = Configuration.model_validate(tomllib.loads(measured.experiment.configurations[case]))
    path, _ = build_path(configuration)
    nodes = np.arange(0.0, path.length, 0.25)
    labels = np.array(path.labels(nodes))
    ends = np.flatnonzero(labels[1:] != labels[:-1]) + 1
    for start, end in zip((0, *ends), (*ends, len(nodes) - 1), strict=True):
        place = CLASSES.index(labels[start])
        if place:
            axes.axvspan(nodes[start], nodes[end], color=GRID, lw=0.0, zorder=0.5)
            middle = (0.5 * (nodes[start] + nodes[end]), 1.02)
            axes.annotate(f"{labels[start]}/m", middle, xycoords=("data", "axes fraction"), ha="center", fontsize=8.0)
        if case != PRODUCT:
            for body, colour in BODY_COLOURS.items():
                axes.hlines(FIELD[body][place], nodes[start], nodes[end], color=colour, lw=0.9, ls=DASHED)


def _draw_means(figure: Figure, measured: MeasuredExperiment) -> None:
    panels = figure.subplots(1, len(CLASSES), sharey=True, sharex=True)
    names = ["the paper, in the field", *measured.cases]
    rows = np.arange(len(names))
    for place, (axes, label, title) in enumerate(zip(panels, CLASSES, TITLES, strict=True)):
        for body, colour in BODY_COLOURS.items():
            statistics = [measured.statistic(case, f"{body} {label}") for case in measured.cases]
            means = [FIELD[body][place], *(statistic.mean for statistic in statistics)]
            widths = [0.0, *(statistic.half_width for statistic in statistics)]
            look = {"fmt": MARKERS[body], "ms": 4.0, "color": colour, "elinewidth": 1.0}
            axes.errorbar(means, rows + (0.14 if body == "trailer" else -0.14), xerr=widths, label=body, **look)
        axes.axhspan(names.index(PRODUCT) - 0.5, names.index(PRODUCT) + 0.5, color=GRID, lw=0.0, zorder=0.5)
        axes.set(xscale="log", xlabel="mean distance, cm", title=title)
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.tick_params(axis="y", length=0.0)
    panels[0].set_yticks(rows, names)
    panels[0].set_ylim(len(names) - 0.5, -0.5)
    panels[0].get_yticklabels()[0].set_color(REFERENCE)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=2)
