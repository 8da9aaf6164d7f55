"""How far every fault takes both bodies from the path, and how long until they are back."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from drawbar.experiment.elements import Element, Picture, Table, Text
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.statistics import Statistic
from drawbar.experiment.task import Result
from drawbar.report.style import ESTIMATOR, GRID, INK, KINK, REFERENCE, TRACTOR, TRAILER
from drawbar.vehicle.parameters import BODIES

PRODUCT = "articulated"
CENTRALISED = "#56B4E9"  # of the same palette as the others
NEAR = 0.15
"""distance from the path under which both bodies must stay to count as back, m"""
LATE = 35.0
"""10 s after the events, s"""
OVERSHOOT = 20.0
"""time at the start in which the path may be crossed to its other side, s"""
SLOPES = "side slope"
"""how the names of the variants begin that have two limits, one of them from 10 s after the onset on"""
STARTS = "starts"
"""how the names of the variants begin that do not start on the path"""
EVENTS = (
    "no event",
    "GPS lost 3 s",
    "GPS lost 10 s",
    "GPS held 10 s",
    "μ to 0.7",
    "κ to 0.7",
    "bump to the left",
    "side slope 3° to the left",
)
"""variants of which the worst of all seeds is shown, for the paper's set and the product"""
LARGEST = tuple(f"{body} largest" for body in BODIES)
LATE_LARGEST = tuple(f"{body} after 10 s" for body in BODIES)
LOOKS = {
    PRODUCT: {"color": TRACTOR, "marker": "o", "ms": 6.0, "zorder": 3.0},
    "articulated-centralised": {"color": CENTRALISED, "marker": "D", "ms": 4.0},
    "articulated-ekf": {"color": ESTIMATOR, "marker": "x", "ms": 5.0, "mew": 1.4},
    "articulated-ideal": {"color": INK, "marker": "+", "ms": 6.0, "mew": 1.2},
    "lqr-pi": {"color": KINK, "marker": "^", "ms": 5.0},
    "paper": {"color": REFERENCE, "marker": "s", "ms": 4.0},
}
MISSED = {**LOOKS[PRODUCT], "color": TRAILER}


def figures(result: Result) -> dict[str, float]:
    """Return the largest distances of a run, cm, how long both bodies were away, s, and the overshoot, cm."""
    time = result.columns["measurement.time"]
    errors = np.array([result.columns[f"error.{body}"] for body in BODIES])
    return {
        **dict(zip(LARGEST, _largest(errors), strict=True)),
        **dict(zip(LATE_LARGEST, _largest(errors[:, time >= LATE]), strict=True)),
        "settled": _away(time, errors) if result.metrics.finished else np.nan,
        "overshoot": 100.0 * _overshoot(errors[:, time <= OVERSHOOT]),
    }


def _largest(errors: np.ndarray) -> list[float]:
    """Return each body's largest distance from the path, cm; NaN where the run did not last that long."""
    return (100.0 * np.abs(errors).max(axis=1)).tolist() if errors.size else [np.nan] * len(errors)


def _away(time: np.ndarray, errors: np.ndarray) -> float:
    """Return the time from when a body is first further than NEAR to when both are back for good; NaN if never."""
    away = np.flatnonzero(~(np.abs(errors).max(axis=0) <= NEAR))
    if not away.size:
        return 0.0
    return float(time[away[-1] + 1] - time[away[0]]) if away[-1] + 1 < len(time) else np.nan


def _overshoot(errors: np.ndarray) -> float:
    """Return how far a body gets to the other side of the path than the tractor starts on; NaN for a start on it."""
    first = errors[0, 0]
    return max(float((-np.sign(first) * errors).max()), 0.0) if abs(first) > NEAR else np.nan


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the picture, the product's table, the comparators' table, and those of the slopes and the starts."""
    yield Picture(
        name="robustness",
        caption="Largest distance from the path in a run, mean over the seeds with its 95 % interval, logarithmic. "
        "Ticks: what the product must not exceed.",
        draw=lambda figure: _draw(figure, measured),
        size=(9.5, 0.19 * len(_variants(measured)) + 1.3),
    )
    yield _product(measured)
    yield _comparators(measured)
    yield _events(measured)
    yield Text(text=_nearer(measured))
    yield _slopes(measured)
    yield _starts(measured)


def _name(case: str, variant: str) -> str:
    return f"{case}: {variant}"


def _variants(measured: MeasuredExperiment) -> list[str]:
    """Return the variants that start on the path: of the others the largest distance is that of the start."""
    return [variant for variant in _all_variants(measured) if not variant.startswith(STARTS)]


def _all_variants(measured: MeasuredExperiment) -> list[str]:
    return [variant.name for variant in measured.experiment.settings.variants]


def _cases(measured: MeasuredExperiment) -> list[str]:
    return [case.name for case in measured.experiment.settings.cases]


def _limit(measured: MeasuredExperiment, variant: str, figure: str) -> float:
    """Return what a figure of the product must not exceed; NaN where nothing is said."""
    expected = measured.experiment.settings.expected.get(_name(PRODUCT, variant), {}).get(figure)
    return np.nan if expected is None or expected.at_most is None else expected.at_most


def _cell(statistic: Statistic, limit: float) -> str:
    """Return mean ± interval, the worst seed and the limit; bold where the limit is missed."""
    text = f"{statistic.text()} ({statistic.largest:.1f})"
    if np.isnan(limit):
        return text
    return f"{text if statistic.mean <= limit else f'**{text}**'} ≤ {limit:g}"


def _product(measured: MeasuredExperiment) -> Table:
    rows = []
    for variant in _variants(measured):
        case = _name(PRODUCT, variant)
        largest = [_cell(measured.statistic(case, name), _limit(measured, variant, name)) for name in LARGEST]
        settled = measured.statistic(case, "settled")
        away = "–" if np.isnan(settled.mean) else f"{settled.text()} ({settled.largest:.1f})"
        rows.append([variant, measured.finished(case), *largest, away])
    return Table(
        name="product",
        caption=f"`{PRODUCT}`: largest distance from the path in a run, cm, and time from when a body is first more "
        "than 15 cm away to when both are back for good, s. Mean over the seeds ± 95 % interval (worst seed) and, "
        "where there is one, the limit of the mean.",
        header=["", "finished", "tractor, cm", "trailer, cm", "away, s"],
        rows=rows,
    )


def _comparators(measured: MeasuredExperiment) -> Table:
    cases = _cases(measured)
    return Table(
        name="comparators",
        caption="Largest distance from the path, tractor / trailer, cm, mean over the seeds; in brackets how many runs "
        "came to the end, where not all did.",
        header=["", *cases],
        rows=[
            [variant, *(measured.means(_name(case, variant), LARGEST) for case in cases)]
            for variant in _variants(measured)
        ],
    )


def _events(measured: MeasuredExperiment) -> Table:
    cases = ("paper", PRODUCT)
    return Table(
        name="events",
        caption="The same of the worst seed: largest distance of any run, tractor / trailer, cm.",
        header=["event", *cases],
        rows=[[event, *(_worst(measured, _name(case, event)) for case in cases)] for event in EVENTS],
    )


def _worst(measured: MeasuredExperiment, name: str) -> str:
    return measured.with_finished(
        name, " / ".join(f"{measured.statistic(name, figure).largest:.0f}" for figure in LARGEST)
    )


def _nearer(measured: MeasuredExperiment) -> str:
    """Say who stays nearer to the path than the product, with both bodies at once."""
    lines = [f"Comparators whose largest distance is, in the mean, below that of `{PRODUCT}` on both bodies:", ""]
    for case in _cases(measured)[1:]:
        claims = [_claim(measured, case, variant) for variant in _variants(measured)]
        lines.append(f"- `{case}`: {'; '.join(filter(None, claims)) or 'never'}")
    explanation = (
        "In brackets: by how many cm, tractor / trailer, over the same seeds; **bold** where the 95 % intervals of "
        "both differences leave out zero. `…-ideal` knows the true state, which no machine does."
    )
    return "\n".join([*lines, "", explanation])


def _claim(measured: MeasuredExperiment, case: str, variant: str) -> str:
    """Return the variant with the margins by which a comparator beats the product; empty if it does not."""
    name, product = _name(case, variant), _name(PRODUCT, variant)
    if name not in measured.runs:
        return ""
    margins = [_margin(measured, name, product, figure) for figure in LARGEST]
    if not all(margin.mean > 0.0 for margin in margins):
        return ""
    text = f"{variant} ({' / '.join(margin.text() for margin in margins)})"
    return f"**{text}**" if all(margin.mean > margin.half_width for margin in margins) else text


def _margin(measured: MeasuredExperiment, name: str, product: str, figure: str) -> Statistic:
    """Return by how much a comparator is nearer to the path than the product, seed by seed."""
    pairs = zip(measured.values(product, figure), measured.values(name, figure), strict=False)
    return Statistic.of([own - other for own, other in pairs])


def _slopes(measured: MeasuredExperiment) -> Table:
    rows = []
    for variant in (variant for variant in _all_variants(measured) if variant.startswith(SLOPES)):
        limits = [f"≤ {_limit(measured, variant, name):g}" for name in (*LARGEST, *LATE_LARGEST)]
        rows.append([variant, "limit of `articulated`", *limits])
        for case in _cases(measured):
            if (name := _name(case, variant)) in measured.runs:
                cells = [measured.statistic(name, figure).text() for figure in (*LARGEST, *LATE_LARGEST)]
                rows.append([variant, case, *cells])
    return Table(
        name="slopes",
        caption="Side slopes: largest distance in the whole run and from 10 s after the onset on, cm.",
        header=["", "", *LARGEST, *LATE_LARGEST],
        rows=rows,
    )


def _starts(measured: MeasuredExperiment) -> Table:
    rows = []
    for variant in (variant for variant in _all_variants(measured) if variant.startswith(STARTS)):
        for case in _cases(measured):
            name = _name(case, variant)
            if name in measured.runs:
                cells = [measured.statistic(name, figure) for figure in ("settled", "overshoot")]
                rows.append([variant, case, measured.finished(name), *(cell.text() for cell in cells)])
    return Table(
        name="starts",
        caption="Starts off the path: time until both bodies stay within 15 cm for good, s, and how far a body gets to "
        "the other side within the first 20 s, cm. –: not within 15 cm at the end of every run, or no side.",
        header=["", "", "finished", "settled, s", "overshoot, cm"],
        rows=rows,
    )


def _draw(figure: Figure, measured: MeasuredExperiment) -> None:
    variants = _variants(measured)
    for axes, body, name in zip(figure.subplots(1, 2, sharey=True, sharex=True), BODIES, LARGEST, strict=True):
        for row, variant in enumerate(variants):
            limit = _limit(measured, variant, name)
            axes.plot([limit] * 2, [row - 0.42, row + 0.42], color=INK, lw=1.0, zorder=2.0)
            for case in reversed(_cases(measured)):
                if (case_name := _name(case, variant)) in measured.runs:
                    _draw_dot(axes, row, case, measured.statistic(case_name, name), limit)
        for row in range(1, len(variants), 2):
            axes.axhspan(row - 0.5, row + 0.5, color=GRID, alpha=0.5, lw=0.0, zorder=0.5)
        axes.set(xscale="log", xlabel="largest distance, cm", title=body, xlim=(1.0, None))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.tick_params(axis="y", length=0.0)
        axes.grid(axis="y", visible=False)
        axes.set(yticks=range(len(variants)), yticklabels=variants, ylim=(len(variants) - 0.5, -0.5))
    legend = {case: look for case, look in LOOKS.items() if case in _cases(measured)}
    for case, look in (legend | {f"{PRODUCT}, limit missed": MISSED}).items():
        axes.plot([], [], ls="", label=case, **look)
    figure.legend(loc="outside upper center", ncols=3)


def _draw_dot(axes: Axes, row: int, case: str, statistic: Statistic, limit: float) -> None:
    look = MISSED if case == PRODUCT and statistic.mean > limit else LOOKS[case]
    axes.errorbar([statistic.mean], [row], xerr=[np.nan_to_num(statistic.half_width)], elinewidth=0.8, **look)
