"""The paper's guidance: references from the point a fixed distance ahead of the closest one (C: look_ahead.h)."""

from drawbar.guidance.guidance import Guidance, Position
from drawbar.guidance.path import Path
from drawbar.guidance.settings import GuidanceSettings


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
        super().__init__(
            path,
            settings,
            header="look_ahead.h",
            values={"look_ahead": settings.look_ahead, "advance": (speed * interval, 0.0)},
            stages=stages,
            tractor=tractor,
            trailer=trailer,
        )
