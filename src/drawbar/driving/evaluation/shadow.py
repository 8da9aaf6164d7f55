"""Shadow: what drawbar would have done beside what the driver did, from the log of a drive at which it looked on."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drawbar.recording.log import Columns
from drawbar.signals import Status

COMPARED = (
    "status",
    *(f"{body}_steering.command" for body in ("tractor", "trailer")),
    *(f"measurement.{body}_steering" for body in ("tractor", "trailer")),
)
"""numbers of the steps that are needed"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SteeringDifference:
    """By how much the steering of one body would have been another."""

    body: str
    steps: int
    """at which both are known"""
    mean: float
    """of the amounts, rad; NaN where there is no such step"""
    largest: float
    """rad"""


def steering_differences(log: Columns) -> tuple[SteeringDifference, SteeringDifference]:
    """Return how far the commands were from the angles that the driver had steered a step later, front wheels first."""
    commanded = log.column("status")[:-1] < Status.REFUSED
    return (
        _difference(log, "tractor", 1, commanded),
        _difference(log, "trailer", log.header.vehicle.joint_sign, commanded),
    )


def _difference(log: Columns, body: str, sign: int, commanded: NDArray[np.bool_]) -> SteeringDifference:
    amounts = np.abs(
        sign * log.column(f"{body}_steering.command")[:-1] - log.column(f"measurement.{body}_steering")[1:]
    )
    amounts = amounts[commanded & np.isfinite(amounts)]
    known = len(amounts) > 0
    return SteeringDifference(
        body=body,
        steps=len(amounts),
        mean=float(amounts.mean()) if known else math.nan,
        largest=float(amounts.max()) if known else math.nan,
    )


def tell(difference: SteeringDifference) -> str:
    """Return a difference in words."""
    name = {"tractor": "front wheels", "trailer": "joint"}[difference.body]
    if not difference.steps:
        return (
            f"{name}: no measured angle was received; AIO v4 boards tell theirs only while something commands them, "
            "AiO_26 boards and ISOBUS valves always"
        )
    mean, largest = math.degrees(difference.mean), math.degrees(difference.largest)
    return f"{name}: {mean:.1f}° on average and {largest:.1f}° at most from the driver's, over {difference.steps} steps"
