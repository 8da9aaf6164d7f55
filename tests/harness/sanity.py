"""What watches a run's sense, by itself."""

import math
from ctypes import byref

from alone import Alone
from c_signals import CBodyReference, Real, given

from drawbar.safety.sanity import SanitySettings, sanity_unit
from drawbar.signals import BodyReference, Estimate, Measurement
from drawbar.vehicle.parameters import VehicleParameters


class Sanity(Alone):
    """Slower, or the end of a run, for what its sensors show."""

    def __init__(self, settings: SanitySettings | None = None, position: float = 0.03) -> None:
        """Take when to do what, and the standard deviation of a fix, m."""
        super().__init__(sanity_unit(VehicleParameters(), settings or SanitySettings(), position=position))

    def look(
        self,
        measurement: Measurement,
        estimate: Estimate,
        tractor: BodyReference,
        trailer: BodyReference,
        departure: float = math.nan,
    ) -> tuple[int, float]:
        """Return 0 or the status with which the run ends, and the part of the set speed that may be driven.

        departure: of the yaw by fixes and angles from the yaw rate, rad.
        """
        share = Real()
        references = [byref(CBodyReference.of(each)) for each in (tractor, trailer)]
        seen = (given(measurement), given(measurement), given(estimate), *references)
        status = self.call("look", *seen, Real(departure), byref(share))
        return status, share.value
