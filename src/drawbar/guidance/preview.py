"""Preview guidance: the path itself, at the pace at which the vehicle will cover it over the horizon (C: preview.h)."""

import math

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import wrap
from drawbar.guidance.guidance import Guidance, GuidanceStatus, Position
from drawbar.guidance.path import Path
from drawbar.guidance.settings import GuidanceSettings
from drawbar.signals import Estimate
from drawbar.vehicle.parameters import VehicleParameters


class Preview(Guidance):
    """Stage j of each body is the path at its progress plus j mu v dt; it never moves back.

    A tractor that faces away from what it shall follow is led onto the path by turns (approach.h); the trailer comes
    after as it may.
    """

    def __init__(
        self,
        path: Path,
        settings: GuidanceSettings,
        *,
        vehicle: VehicleParameters,
        stages: int,
        interval: float,
        tractor: Position,
        trailer: Position,
    ) -> None:
        """Prepare references of stages + 1 samples, interval (s) apart; otherwise as Guidance."""
        values = {
            "limits.curvature": vehicle.curvature_limit,
            "limits.rate": settings.curvature_rate_limit,
            "interval": interval,
            "wheelbase": vehicle.wheelbase,
            "room": settings.turning_room,
        }
        super().__init__(
            path, settings, header="preview.h", values=values, stages=stages, tractor=tractor, trailer=trailer
        )
        self._limits = vehicle.curvature_limit, settings.curvature_rate_limit, settings.turning_room

    def _refusal(self, status: int, estimate: Estimate) -> PathError:
        if status == GuidanceStatus.SPEED_NOT_FINITE:
            speed = estimate.longitudinal_slip * estimate.speed
            return PathError(f"guidance: the estimated speed over ground is {speed} m/s; stop the vehicle")
        if status == GuidanceStatus.NO_WAY:
            return self._no_way(estimate)
        return super()._refusal(status, estimate)

    def _no_way(self, estimate: Estimate) -> PathError:
        tractor, progress = estimate.tractor, self.component.array("guidance.progress")[0]
        curvature, rate, room = self._limits
        turned = wrap(tractor.yaw - float(self.path.sample(np.array(progress))[2]))
        return PathError(
            f"the tractor at ({tractor.x:z.2f}, {tractor.y:z.2f}) m faces {math.degrees(turned):.0f}° away from the "
            f"path; no turns of at most {curvature:g} 1/m and {rate:g} 1/m² lead onto it within "
            f"{room:g} m beside it: turn the vehicle by hand, or raise guidance.turning_room or "
            f"vehicle.curvature_limit"
        )
