"""How far real ground, untold delays and coarse fixes take both bodies' points on the ground from the path."""

from collections.abc import Iterator

from drawbar.experiment.comparison import comparison
from drawbar.experiment.distances import BEGINS, distance_figures
from drawbar.experiment.elements import Element, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result
from drawbar.vehicle.parameters import BODIES

PRODUCT = "articulated"


def figures(result: Result) -> dict[str, float]:
    """Return both bodies' distances, cm, the share of masked fixes, and what was found of the steering."""
    found = distance_figures(result, "tractor") | distance_figures(result, "trailer")
    found["masked"] = 100.0 * result.metrics.rejected_fixes / (2 * len(result.columns["measurement.time"]))
    found["dead time"] = float(result.columns["actuation.dead_time"][-1])
    found["lag"] = float(result.columns["actuation.tractor_lag"][-1])
    return found


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the product's table, the comparators' and who is nearer than the product."""
    yield _product(measured)
    yield from comparison(measured, PRODUCT)


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
        "standard deviation of the signed distance, that on all straights, on each straight by itself after its first "
        f"{BEGINS:g} m, 95 %, means over the seeds (largest of all seeds), cm; limits of the mean and of every run "
        "where there are any, bold where one is missed. Fixes that were not believed, %; dead time and lag that were "
        "planned with at the end, s.",
        header=["", "finished", *BODIES, "masked, %", "dead time, s", "lag, s"],
        rows=rows,
    )


def _body(measured: MeasuredExperiment, case: str, body: str) -> str:
    """Return mean / SD / SD on straights / on each / 95 % (largest), and the limits; bold where one is missed."""
    names = ("mean", "SD", "straight SD", "each straight SD", "95 %")
    mean, *others = (measured.statistic(case, f"{body} {name}").mean for name in names)
    largest = measured.statistic(case, f"{body} largest").largest
    expected = measured.experiment.settings.expected.get(case, {})
    limits = [(expected.get(f"{body} mean"), mean), (expected.get(f"{body} largest"), largest)]
    asked = [(limit, found) for limit, found in limits if limit is not None]
    text = " / ".join(f"{value:.1f}" for value in (mean, *others)) + f" ({largest:.0f})"
    shown = text if all(limit.holds(found) for limit, found in asked) else f"**{text}**"
    return " ".join([shown, "; ".join(str(limit) for limit, _ in asked)]).rstrip()
