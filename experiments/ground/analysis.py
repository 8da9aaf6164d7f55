"""How far real ground, untold delays and coarse fixes take both bodies' points on the ground from the path."""

from collections.abc import Iterator

import numpy as np

from drawbar.experiment.comparison import comparison
from drawbar.experiment.elements import Element, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result

PRODUCT = "articulated"
BODIES = ("tractor", "trailer")
MEANS = tuple(f"{body} mean" for body in BODIES)
LARGEST = tuple(f"{body} largest" for body in BODIES)
BEGINS = 5.0
"""way along the path that is left out at the start, m"""
STRAIGHT = "straight"


def figures(result: Result) -> dict[str, float]:
    """Return mean, standard deviation, 95 % and largest distance of both bodies, cm, and the share of masked fixes."""
    found: dict[str, float] = {}
    for body in BODIES:
        error, progress = (100.0 * result.columns[f"error.{body}"], result.columns[f"progress.{body}"])
        error = error[progress - np.nanmin(progress) > BEGINS]
        found |= {f"{body} {name}": value for name, value in _summary(error).items()}
        found[f"{body} straight SD"] = _straight_deviation(result, body)
    steps = 2 * len(result.columns["measurement.time"])
    found["masked"] = 100.0 * result.metrics.rejected_fixes / steps
    found["dead time"] = float(result.columns["actuation.dead_time"][-1])
    found["lag"] = float(result.columns["actuation.tractor_lag"][-1])
    return found


def _summary(error: np.ndarray) -> dict[str, float]:
    size = np.abs(error)
    if not size.size:
        return dict.fromkeys(("mean", "SD", "95 %", "largest"), float("nan"))
    return {
        "mean": float(size.mean()),
        "SD": float(error.std()),
        "95 %": float(np.percentile(size, 95.0)),
        "largest": float(size.max()),
    }


def _straight_deviation(result: Result, body: str) -> float:
    """Return the standard deviation of the error on the straights, root of the mean over them of its square, cm."""
    statistics = getattr(result.metrics.error_m, body)[STRAIGHT]
    return 100.0 * float(statistics.rms)


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the product's table, the comparators' and who is nearer than the product."""
    yield _product(measured)
    yield from comparison(measured, PRODUCT, MEANS, LARGEST)


def _product(measured: MeasuredExperiment) -> Table:
    rows = []
    for variant in [each.name for each in measured.experiment.settings.variants]:
        case = f"{PRODUCT}: {variant}"
        cells = [_body(measured, case, body) for body in BODIES]
        found = [measured.statistic(case, name) for name in ("masked", "dead time", "lag")]
        rows.append([variant, measured.finished(case), *cells, *(f"{each.mean:.2f}" for each in found)])
    return Table(
        name="product",
        caption=f"`{PRODUCT}`: distance of the points on the ground from the path after the first {BEGINS:g} m: mean, "
        "standard deviation of the signed distance, that on the straights, 95 %, means over the seeds (largest of all "
        "seeds), cm; limits of the mean and of every run where there are any, bold where one is missed. Fixes that "
        "were not believed, %; dead time and lag that were planned with at the end, s.",
        header=["", "finished", *BODIES, "masked, %", "dead time, s", "lag, s"],
        rows=rows,
    )


def _body(measured: MeasuredExperiment, case: str, body: str) -> str:
    """Return mean / SD / SD on straights / 95 % (largest), and the limits; bold where one is missed."""
    names = ("mean", "SD", "straight SD", "95 %")
    mean, *others = (measured.statistic(case, f"{body} {name}").mean for name in names)
    largest = measured.statistic(case, f"{body} largest").largest
    expected = measured.experiment.settings.expected.get(case, {})
    limits = [(expected.get(f"{body} mean"), mean), (expected.get(f"{body} largest"), largest)]
    asked = [(limit, found) for limit, found in limits if limit is not None]
    text = " / ".join(f"{value:.1f}" for value in (mean, *others)) + f" ({largest:.0f})"
    shown = text if all(limit.holds(found) for limit, found in asked) else f"**{text}**"
    return " ".join([shown, "; ".join(str(limit) for limit, _ in asked)]).rstrip()
