"""What watches a run's sense, by itself."""

import math
from ctypes import byref

import numpy as np
from alone import Alone
from c_signals import CBodyReference, Real, given
from ordinary import believed, measured

from drawbar.safety.sanity import SanitySettings, sanity_unit
from drawbar.signals import BodyReference, Estimate, Measurement, Pose
from drawbar.vehicle.parameters import VehicleParameters

SAMPLE = 0.2


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
        status = self.call("judge", *seen, Real(departure), byref(share))
        return status, share.value


def estimate(yaw: float = 0.0, steering: float = 0.0, speed: float = 0.0) -> Estimate:
    pose = Pose(x=0.0, y=0.0, yaw=yaw)
    return believed(pose, pose, tractor_steering=steering, speed=speed)


def beside(error: float, curvature: float = 0.0) -> BodyReference:
    closest = np.array([0.0, 0.0, 0.0, curvature])
    return BodyReference(progress=0.0, lateral_error=error, closest=closest, samples=np.zeros((2, 4)))


def measurement(k: int, speed: float = 1.0, moved: float | None = None, deviation: float = math.nan) -> Measurement:
    """Return sample k of a vehicle that drives east by the wheels' speed, or so far (m) at this sample."""
    x = SAMPLE * k * speed if moved is None else moved
    told = dict.fromkeys(("tractor_fix_deviation", "trailer_fix_deviation"), deviation)
    return measured(x, 0.0, x - 2.0, 0.0, time=SAMPLE * k, speed=speed, **told)
