"""Preview guidance: the path itself, at the pace at which the vehicle will cover it over the horizon."""

import math

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats
from drawbar.guidance.approach import Approach
from drawbar.guidance.guidance import Guidance, Position
from drawbar.guidance.path import Path
from drawbar.guidance.settings import GuidanceSettings
from drawbar.signals import Estimate


class Preview(Guidance):
    """Stage j of each body is the path at its progress plus j mu v dt; it never moves back.

    The offset that a body has at first is blended in and fades (see Approach).
    """

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
        self._approaches: tuple[Approach, ...] = ()

    def _stages(self, estimate: Estimate) -> Floats:
        speed = estimate.longitudinal_slip * estimate.speed
        if not math.isfinite(speed):
            raise PathError(f"guidance: the estimated speed over ground is {speed} m/s; stop the vehicle")
        np.maximum(self._furthest, self._progress(), out=self._furthest)
        ahead: Floats = np.multiply(speed, self._times)
        return self._furthest + ahead

    def _samples(self, stages: Floats, offsets: tuple[float, float]) -> Floats:
        samples = super()._samples(stages, offsets)
        if not self._approaches:
            self._approaches = tuple(
                Approach(start=start, offset=offset, length=self.settings.approach_length)
                for start, offset in zip(stages[:, 0].tolist(), offsets, strict=True)
            )
        for approach, arc_length, body in zip(self._approaches, stages, samples, strict=True):
            approach.bend(arc_length, body)
        return samples
