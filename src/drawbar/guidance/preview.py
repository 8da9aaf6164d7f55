"""Preview guidance: the path itself, at the pace at which the vehicle will cover it over the horizon."""

import math

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats
from drawbar.guidance.guidance import Guidance, Position
from drawbar.guidance.path import Path
from drawbar.guidance.settings import GuidanceSettings
from drawbar.signals import Estimate


class Preview(Guidance):
    """Stage j of each body is the path at its progress plus j mu v dt; it never moves back."""

    def __init__(
        self,
        path: Path,
        settings: GuidanceSettings,
        *,
        stages: int,
        interval: float,
        tractor: Position,
        trailer: Position,
    ) -> None:
        """Prepare references of stages + 1 samples, interval (s) apart; otherwise as Guidance."""
        super().__init__(path, settings, tractor=tractor, trailer=trailer)
        self._times = interval * np.arange(stages + 1)
        self._furthest = np.full((2, 1), -np.inf)

    def _stages(self, estimate: Estimate) -> Floats:
        speed = estimate.longitudinal_slip * estimate.speed
        if not math.isfinite(speed):
            raise PathError(f"guidance: the estimated speed over ground is {speed} m/s; stop the vehicle")
        np.maximum(self._furthest, self._progress(), out=self._furthest)
        ahead: Floats = np.multiply(speed, self._times)
        return self._furthest + ahead
