"""World: the simulated machine of a stand-in, moved on in small ticks by whoever steers and drives it."""

import math

from drawbar.machine.base import MachineWithTruth
from drawbar.signals import Command, Measurement, Truth
from drawbar.vehicle.parameters import VehicleParameters

TICK = 0.02
"""s; what steers it is asked again at each"""


class World:
    """A simulated tractor and trailer at ticks."""

    def __init__(self, machine: MachineWithTruth, vehicle: VehicleParameters) -> None:
        """Take the machine, whose sample time is TICK, and the vehicle with its limits."""
        self._machine, self._vehicle = machine, vehicle
        self.measurement: Measurement = machine.read()

    @property
    def truth(self) -> Truth:
        """The true state now."""
        return self._machine.truth()

    def tick(self, tractor: float | None, trailer: float | None, speed: float) -> None:
        """Let a tick pass.

        Args:
            tractor: set point of the front wheels, rad; None: nobody turns them.
            trailer: set point of the joint, rad, in the sign in which it is measured; None: nobody turns it.
            speed: of the wheels, m/s.
        """
        truth, vehicle = self.truth, self._vehicle
        tractor = truth.tractor_steering if tractor is None else tractor
        trailer = truth.trailer_steering if trailer is None else trailer
        self._machine.write(
            Command(
                time=truth.time,
                tractor_steering=_within(tractor, vehicle.tractor_steering_limit),
                trailer_steering=vehicle.joint_sign * _within(trailer, vehicle.trailer_steering_limit),
                speed=speed,
            )
        )
        self.measurement = self._machine.read()


def _within(angle: float, stop: float) -> float:
    """Return where the steering ends up that is asked for an angle, rad: at its stop at most."""
    return min(max(angle, -stop), stop) if math.isfinite(angle) else 0.0
