"""The paper's guidance: references from the point a fixed distance ahead of the closest one."""

import numpy as np

from drawbar.geometry import Floats
from drawbar.guidance.guidance import Guidance, Position
from drawbar.guidance.path import Path
from drawbar.guidance.settings import GuidanceSettings
from drawbar.signals import Estimate


class LookAhead(Guidance):
    """The tractor's reference advances from the point ahead at nominal speed, the trailer's stays there."""

    def __init__(
        self,
        path: Path,
        settings: GuidanceSettings,
        *,
        stages: int,
        interval: float,
        speed: float,
        tractor: Position,
        trailer: Position,
    ) -> None:
        """Prepare references of stages + 1 samples, interval (s) apart at speed (m/s); else as Guidance."""
        super().__init__(path, settings, tractor=tractor, trailer=trailer)
        advance = speed * interval * np.arange(stages + 1)
        self._offsets = settings.look_ahead + np.stack([advance, np.zeros_like(advance)])

    def _samples(self, estimate: Estimate) -> Floats:
        return self.path.sample(self._offsets + self._progress())
