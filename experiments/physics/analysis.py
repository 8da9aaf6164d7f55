"""How far the product is from the path in the physics, beside what an independent physics plant measured."""

from collections.abc import Iterator

import numpy as np

from drawbar.experiment.comparison import comparison
from drawbar.experiment.distances import BEGINS, distance_figures
from drawbar.experiment.elements import Element, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result
from drawbar.vehicle.parameters import BODIES

PRODUCT = "articulated"
VALIDATION = {
    "flat, 1 m/s": ("0.9 / 2.4 / 4", "1.0 / 3.0 / 7"),
    "flat, 2 m/s": ("1.6 / 3.7 / 6", "1.7 / 5.1 / 9"),
    "flat, 3 m/s": ("1.9 / 4.8 / 6", "2.5 / 7.0 / 13"),
    "slope 5°, no attitude": ("14.2", "12.1"),
    "slope 5° soft, masts of 0 m": ("1.8 / 4.4 / 7", "3.6 / 10 / 12"),
    "uneven 4 cm, no attitude": ("8.3 / 21 / 43", "6.9 / 18 / 36"),
    "uneven 4 cm, attitude on both": ("1.1 / 2.5 / 7", "1.3 / 3.6 / 5"),
    "field, no attitude": ("12.9 / 23 / 27", "9.9 / 19 / 21"),
    "field, attitude on the tractor": ("1.8 / 4.1 / 6", "6.2 / 12 / 14"),
    "field, attitude on both": ("1.8 / 4.3 / 6", "3.4 / 9.5 / 14"),
    "field, attitude on both, 2 m/s": ("2.0 / 5.3 / 9", "2.5 / 5.4 / 9"),
    "field, attitude on both, 2 m/s, soft as a contact": ("2.0 / 5.3 / 9", "2.5 / 5.4 / 9"),
}
"""mean / 95 % / max of an independent validation's own plant, commit da1c574, two seeds; attitude there: ideal lever
arm before the autopilot, with noise of 0.3° in the field; on the tractor alone: nothing predicts the trailer's roll"""


def figures(result: Result) -> dict[str, float]:
    """Return both bodies' distances, cm, masked fixes, %, and root mean square of the tractor's roll, °."""
    found = distance_figures(result, "tractor") | distance_figures(result, "trailer")
    found["masked"] = 100.0 * result.metrics.rejected_fixes / (2 * len(result.columns["measurement.time"]))
    found["roll"] = float(np.degrees(np.sqrt(np.mean(result.columns["truth.tractor_roll"] ** 2))))
    return found


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the product's table, the comparators' and who is nearer than the product."""
    variants = [variant.name for variant in measured.experiment.settings.variants]
    yield Table(
        name="product",
        caption=f"`{PRODUCT}`: distance of the points on the ground from the path after the first {BEGINS:g} m: mean / "
        "95 % (means over the seeds) / largest of all seeds, and in brackets the standard deviation of the signed "
        f"distance, that on all straights, and on each straight by itself after its first {BEGINS:g} m, cm, beside the "
        "independent validation's mean / 95 % / max of two seeds. Fixes that were not believed, %; root mean "
        "square of the tractor's roll, °.",
        header=["", "finished", "tractor", "validation", "trailer", "validation", "masked, %", "roll, °"],
        rows=[_row(measured, variant) for variant in variants],
    )
    yield from comparison(measured, PRODUCT)


def _row(measured: MeasuredExperiment, variant: str) -> list[str]:
    case = f"{PRODUCT}: {variant}"
    cells = [variant, measured.finished(case)]
    for body, validated in zip(BODIES, VALIDATION.get(variant, ("", "")), strict=True):
        names = ("mean", "95 %", "SD", "straight SD", "each straight SD")
        mean, high, *spread = (measured.statistic(case, f"{body} {name}").mean for name in names)
        largest = measured.statistic(case, f"{body} largest").largest
        spreads = "; ".join(f"{each:.1f}" for each in spread)
        cells += [f"{mean:.1f} / {high:.1f} / {largest:.0f} ({spreads})", validated]
    return [*cells, *(f"{measured.statistic(case, name).mean:.2f}" for name in ("masked", "roll"))]
