"""What each reading of the paper comes to: distances by curvature, the worst of all runs, yaw and solver failures."""

import math
from collections.abc import Iterator

from drawbar.experiment.analysis import error_figures
from drawbar.experiment.elements import Element, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result
from drawbar.vehicle.parameters import BODIES

CLASSES = {"straight": "straight", "0.1": "0.1 1/m", "0.125": "0.125", "0.15": "0.15"}
"""of the path, and how the table calls them"""


def figures(result: Result) -> dict[str, float]:
    """Return distances of one run, cm, the RMS errors of the estimated yaws, °, and its solver failures."""
    yaw = result.metrics.yaw_rmse_rad
    return error_figures(result.metrics) | {
        "tractor yaw": math.degrees(yaw.tractor),
        "trailer yaw": math.degrees(yaw.trailer),
        "failures": float(result.metrics.solver_failures),
    }


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the table."""
    yield Table(
        name="readings",
        caption="Distance of the points on the ground from the path, tractor / trailer, cm: mean by class of the path "
        "over all seeds, and the largest of any; largest RMS error of the estimated yaw of any seed; solver calls of "
        "all seeds that did not end in SOLVED.",
        header=["reading", *CLASSES.values(), "largest, cm", "yaw, °", "failures"],
        rows=[_row(measured, case) for case in measured.cases],
    )


def _row(measured: MeasuredExperiment, case: str) -> list[str]:
    finished = measured.finished(case)
    lost = finished != f"{measured.seeds}/{measured.seeds}"
    means = [[measured.statistic(case, f"{body} {label}").mean for body in BODIES] for label in CLASSES]
    largest, yaw = (
        [measured.statistic(case, f"{body} {name}").largest for body in BODIES] for name in ("largest", "yaw")
    )
    return [
        f"{case} ({finished} finished)" if lost else case,
        *(f"{tractor:.1f} / {trailer:.1f}" for tractor, trailer in means),
        "{:.0f} / {:.0f}".format(*largest),
        "{:.1f} / {:.1f}".format(*yaw),
        f"{sum(measured.values(case, 'failures')):.0f}",
    ]
