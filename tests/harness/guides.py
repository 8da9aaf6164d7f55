"""Both kinds of guidance, each by itself."""

from ctypes import byref

from alone import Alone
from c_signals import CBodyReference, Real, given
from ordinary import measured

from drawbar.codegen import Unit
from drawbar.guidance.guidance import look_ahead_unit, preview_unit
from drawbar.guidance.path import CPath, Path
from drawbar.guidance.settings import GuidanceSettings
from drawbar.signals import Estimate, GuidanceStatus, Reference
from drawbar.vehicle.parameters import VehicleParameters

Position = tuple[float, float]
"""east and north, m"""


class Guidance(Alone):
    """The progress of both bodies along a path."""

    def __init__(self, unit: Unit, stages: int, path: Path, tractor: Position, trailer: Position, start: float) -> None:
        """Begin at an arc length (m) of a path, from where both bodies stand (m)."""
        super().__init__(unit)
        self._stages, self.path = stages, path
        first = measured(*tractor, *trailer)
        self.begun = GuidanceStatus(
            self.call("begin", byref(CPath(path.nodes)), Real(start), given(first), byref(Real()))
        )
        self._tractor, self._trailer = CBodyReference(), CBodyReference()

    @property
    def finished(self) -> bool:
        """Whether the tractor has reached the end of the path."""
        return bool(self.call("finished", byref(CPath(self.path.nodes))))

    def advance(self, estimate: Estimate) -> GuidanceStatus:
        """Move on to beside the estimate, and tell whether there is a reference."""
        references = byref(self._tractor), byref(self._trailer)
        return GuidanceStatus(
            self.call("reference", byref(CPath(self.path.nodes)), given(estimate), *references, self.work)
        )

    def reference(self, estimate: Estimate) -> Reference:
        """Return what both controllers shall follow now."""
        assert self.advance(estimate) is GuidanceStatus.FINE
        tractor, trailer = (body.read(self._stages) for body in (self._tractor, self._trailer))
        return Reference(time=estimate.time, tractor=tractor, trailer=trailer)

    def rejoin(self) -> None:
        """Lead onto the line anew, from where the bodies next are."""
        self.call("rejoin")

    def change(self, path: Path, start: float, estimate: Estimate) -> GuidanceStatus:
        """Go on along another path near an arc length (m) of it; where that is refused the old one stays."""
        status = GuidanceStatus(self.call("change", byref(CPath(path.nodes)), Real(start), given(estimate)))
        if status is GuidanceStatus.FINE:
            self.path = path
        return status


class Preview(Guidance):
    """Guidance by the path itself."""

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
        start: float = 0.0,
    ) -> None:
        """Begin; see Guidance."""
        unit = preview_unit(settings, vehicle, stages=stages, interval=interval)
        super().__init__(unit, stages, path, tractor, trailer, start)


class LookAhead(Guidance):
    """The paper's guidance."""

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
        start: float = 0.0,
    ) -> None:
        """Begin; see Guidance."""
        unit = look_ahead_unit(settings, stages=stages, interval=interval, speed=speed)
        super().__init__(unit, stages, path, tractor, trailer, start)
