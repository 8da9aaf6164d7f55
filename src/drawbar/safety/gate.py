"""The last look at a command before it leaves: small, and independent of all that made it (gate.h)."""

import ctypes

from drawbar.codegen.component import Component
from drawbar.exchange import CCommand, CMeasurement
from drawbar.signals import Command, GateVerdict, Measurement
from drawbar.vehicle.parameters import VehicleParameters

PATIENCE = 1.0
"""Time for which a command may act without a valid new one, s"""


class CommandGate:
    """Lets finite commands within the limits pass, their steering no further from the wheels than an actuator can tell.

    Otherwise it repeats the last one that passed; when that has acted for PATIENCE, it stops the vehicle with its
    steering held.
    """

    def __init__(
        self, vehicle: VehicleParameters, first: Measurement, *, speed_limit: float, sample_time: float
    ) -> None:
        """Compile the gate.

        Args:
            vehicle: limits, rates, lag and sign of the steering.
            first: tells where the wheels are before any command.
            speed_limit: m/s.
            sample_time: s.

        Raises:
            CompilerError: no compiler, or it refused the code.
        """
        self.component = Component("gate", '#include "gate.h"')
        self.component.write(
            {
                "limits": (vehicle.tractor_steering_limit, vehicle.trailer_steering_limit),
                "signs": (1.0, vehicle.joint_sign),
                "rates": (vehicle.tractor_steering_rate, vehicle.trailer_steering_rate),
                "lag": vehicle.steering_lag,
                "sample_time": sample_time,
                "speed_limit": speed_limit,
                "repeats": max(round(PATIENCE / sample_time) - 1, 0),
            }
        )
        standing = CMeasurement()
        standing.write(first)
        self.component.function("begin", pointers=1)(ctypes.byref(standing))
        self._wanted, self._given = CCommand(), CCommand()
        self._pointers = ctypes.byref(self._wanted), ctypes.byref(self._given)
        self._check = self.component.function("check", pointers=2)

    def check(self, command: Command) -> tuple[Command, GateVerdict]:
        """Return what leaves in this command's place, at its time, and how that came about."""
        self._wanted.write(command)
        verdict = GateVerdict(self._check(*self._pointers))
        return (command if verdict is GateVerdict.PASSED else self._given.read()), verdict
