"""How well recorded lines are followed, and how far they had to be moved to be drivable."""

import math
import tomllib
from collections.abc import Iterator

from drawbar.config import Configuration
from drawbar.experiment.elements import Element, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.simulation import build_path
from drawbar.vehicle.parameters import BODIES

CLASSES = {"straight": "straights", "curve": "curves", "kink": "kinks"}
LIMITS = (0.3, 0.41)
"""of the curvature, 1/m: the product's, and what its mechanical stops allow"""
TOLERANCE = 1.0
"""m: any line is to be made drivable here, whatever it costs"""


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the table."""
    yield Table(
        name="lines",
        caption="Distance of the points on the ground from the path, tractor / trailer, cm: mean by class of the path, "
        "standard deviation of the signed distance and 95 %, means over the seeds, and the largest of any. "
        "Last: largest distance of a recorded point from the path under that limit "
        "of its curvature.",
        header=[
            "line",
            *CLASSES.values(),
            "SD",
            "95 %",
            "largest",
            f"deviation at {' / '.join(map(str, LIMITS))} 1/m, m",
        ],
        rows=[_row(measured, case) for case in measured.cases],
    )


def _row(measured: MeasuredExperiment, case: str) -> list[str]:
    """Return the line's row; a dash where the line has nothing of a class."""
    configuration = Configuration.model_validate(tomllib.loads(measured.experiment.configurations[case]))
    means = [
        [measured.statistic(case, f"{body} {label}").mean for body in BODIES] for label in (*CLASSES, "SD", "95 %")
    ]
    largest = [measured.statistic(case, f"{body} largest").largest for body in BODIES]
    return [
        case,
        *("–" if math.isnan(tractor) else f"{tractor:.1f} / {trailer:.1f}" for tractor, trailer in means),
        "{:.0f} / {:.0f}".format(*largest),
        " / ".join(f"{_deviation(configuration, limit):.3f}" for limit in LIMITS),
    ]


def _deviation(configuration: Configuration, limit: float) -> float:
    """Return the largest distance of a line's points from its drivable path under a curvature limit (1/m), m."""
    vehicle = configuration.vehicle.model_copy(update={"curvature_limit": limit})
    guidance = configuration.guidance.model_copy(update={"path_tolerance": TOLERANCE})
    _, drivable = build_path(configuration.model_copy(update={"vehicle": vehicle, "guidance": guidance}))
    assert drivable is not None
    return float(drivable.deviations.max())
