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
        self._furthest = [-math.inf, -math.inf]
        self._approaches: tuple[Approach, ...] | None = None

    def _stages(self, estimate: Estimate) -> Floats:
        speed = estimate.longitudinal_slip * estimate.speed
        if not math.isfinite(speed):
            raise PathError(f"guidance: the estimated speed over ground is {speed} m/s; stop the vehicle")
        now = (self._tractor_progress, self._trailer_progress)
        self._furthest = [max(pair) for pair in zip(self._furthest, now, strict=True)]
        stages: Floats = np.add.outer(self._furthest, speed * self._times)
        return stages

    def _samples(self, stages: Floats, offsets: tuple[float, float]) -> Floats:
        samples = super()._samples(stages, offsets)
        if self._approaches is None:
            self._approaches = tuple(
                Approach(start=start, offset=offset, length=self.settings.approach_length)
                for start, offset in zip(self._furthest, offsets, strict=True)
            )
        for approach, furthest, arc_length, body in zip(self._approaches, self._furthest, stages, samples, strict=True):
            if furthest <= approach.end:
                approach.bend(arc_length, body)
        return samples
