"""Shadow: what drawbar would have commanded in a drive at which it only looked on, beside what the driver did."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drawbar.driving.evaluation.engageable import Engageable
from drawbar.geometry import Floats
from drawbar.recording.log import Columns
from drawbar.report.path_errors import Bodies, PathErrors, estimated_path_errors
from drawbar.signals import Status


@dataclass(frozen=True, slots=True, kw_only=True)
class Amounts:
    """Of the amounts of an angle, rad, or of a distance, m; NaN where none is known."""

    mean: float
    max: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ShadowMetrics:
    """Figures of a drive at which drawbar only looked on; angles and distances while nothing stood against engaging."""

    judged_s: float
    """how long it is known whether anything stood against engaging"""
    engageable_share: float
    """of that time, in which nothing did; NaN: it is never known"""
    refused_s: Mapping[str, float]
    """for how long each cause did (docs/safety.md), the longest first"""
    compared_steps: Bodies[int]
    """at which a command and the driver's angle one step later are known"""
    angle_measured: Bodies[bool]
    """whether the driver's angles are measured; else they are estimated"""
    difference_rad: Bodies[Amounts]
    """of each command from the driver's angle one step later"""
    driver_error_m: Bodies[Amounts]
    """estimated distance of the driver's vehicle from the line"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedSteering:
    """Commands for one body beside the driver's angles: n steps."""

    command: Floats
    """(n,): made one step before, rad, in the sign of the angles; NaN where none was, or it could not have been sent"""
    driven: Floats
    """(n,): the driver's angle, rad; NaN where it is not known"""
    is_measured: bool
    """else it is estimated"""

    @property
    def differences(self) -> Floats:
        """Those that are known, rad."""
        differences = self.command - self.driven
        return differences[np.isfinite(differences)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Shadow:
    """What drawbar would have done at a drive at which it only looked on."""

    engageable: Engageable
    steerings: Bodies[ComparedSteering]
    errors: Bodies[PathErrors]
    """of the driver, estimated; NaN where something stood against engaging"""

    def metrics(self) -> ShadowMetrics:
        """Return the figures."""
        judged, tractor, trailer = self.engageable.judged, self.steerings.tractor, self.steerings.trailer
        return ShadowMetrics(
            judged_s=judged,
            engageable_share=self.engageable.free / judged if judged > 0.0 else math.nan,
            refused_s={cause.name: lasted for cause, lasted in self.engageable.durations().items()},
            compared_steps=Bodies(tractor=len(tractor.differences), trailer=len(trailer.differences)),
            angle_measured=Bodies(tractor=tractor.is_measured, trailer=trailer.is_measured),
            difference_rad=Bodies(tractor=_amounts(tractor.differences), trailer=_amounts(trailer.differences)),
            driver_error_m=Bodies(
                tractor=_amounts(self.errors.tractor.error), trailer=_amounts(self.errors.trailer.error)
            ),
        )


def compare(log: Columns, engageable: Engageable) -> Shadow:
    """Compare what drawbar would have done in a drive with what the driver did."""
    ready = engageable.at(log.wall_time) & (log.column("status") < Status.REFUSED)
    return Shadow(
        engageable=engageable,
        steerings=Bodies(
            tractor=_compared(log, "tractor", 1, ready),
            trailer=_compared(log, "trailer", log.header.vehicle.joint_sign, ready),
        ),
        errors=estimated_path_errors(log, ready),
    )


def _compared(log: Columns, body: str, sign: int, ready: NDArray[np.bool_]) -> ComparedSteering:
    """Compare the steering of one body; `sign` of its angle after a positive command."""
    command = np.where(ready, sign * log.column(f"{body}_steering.command"), np.nan)
    measured = log.column(f"measurement.{body}_steering")
    is_measured = bool(np.isfinite(measured).any())
    return ComparedSteering(
        command=np.concatenate([[math.nan], command])[: log.steps],
        driven=measured if is_measured else log.column(f"estimate.{body}_steering"),
        is_measured=is_measured,
    )


def _amounts(values: Floats) -> Amounts:
    amounts = np.abs(values[np.isfinite(values)])
    if not amounts.size:
        return Amounts(mean=math.nan, max=math.nan)
    return Amounts(mean=float(amounts.mean()), max=float(amounts.max()))
