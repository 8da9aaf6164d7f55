"""World: the simulated machine of a stand-in, advanced in small ticks under its set points."""

import math

from drawbar.geometry import arm_offset
from drawbar.machine.base import MachineWithTruth
from drawbar.signals import Command, Measurement, Pose, Truth
from drawbar.vehicle.parameters import VehicleParameters

TICK = 0.02
"""s; what steers it is asked again at each"""
_CREEPS = 0.01
"""speed of the vehicle above which its antennas move, m/s"""


class World:
    """A simulated tractor and trailer at ticks."""

    def __init__(self, machine: MachineWithTruth, vehicle: VehicleParameters) -> None:
        """Take the machine, whose sample time is TICK, and the vehicle with its limits."""
        self._machine, self._vehicle = machine, vehicle
        self.measurement: Measurement = machine.read()
        self._before: Truth | None = None

    @property
    def truth(self) -> Truth:
        """The true state now."""
        return self._machine.truth()

    def velocity(self, body: str) -> tuple[float, float]:
        """Return speed, m/s, and yaw, rad, of the velocity of a body's antenna over the last tick.

        At standstill they are zero and the body's yaw.
        """
        if self._before is None or not abs(self.truth.speed) > _CREEPS:
            pose: Pose = getattr(self.truth, body)
            return 0.0, pose.yaw
        (x, y), (east, north) = self._antenna(self._before, body), self._antenna(self.truth, body)
        return math.hypot(east - x, north - y) / TICK, math.atan2(north - y, east - x)

    def _antenna(self, truth: Truth, body: str) -> tuple[float, float]:
        """Return where an antenna is, m."""
        pose, mast = getattr(truth, body), getattr(self._vehicle.masts, body)
        roll, pitch = getattr(truth, f"{body}_roll"), getattr(truth, f"{body}_pitch")
        east, north = arm_offset(pose.yaw, roll, pitch, mast.arm)
        return pose.x + east, pose.y + north

    def tick(self, tractor: float | None, trailer: float | None, speed: float) -> None:
        """Let a tick pass.

        Args:
            tractor: set point of the front wheels, rad; None: not actuated.
            trailer: set point of the joint, rad, in the sign in which it is measured; None: not actuated.
            speed: of the wheels, m/s.
        """
        truth, vehicle = self.truth, self._vehicle
        self._before = truth
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
