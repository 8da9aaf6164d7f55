"""Machines whose sensors of hitch and joint have wrong scales, as with a wrong number of counts per degree."""

from dataclasses import dataclass, replace

from drawbar.config import load_configuration
from drawbar.machine.base import MachineWithTruth
from drawbar.signals import Command, Measurement, Truth
from drawbar.simulation import Simulation


@dataclass(frozen=True)
class ScaledSensors(MachineWithTruth):
    """A machine whose sensors of hitch and joint have wrong scales; its joint is moved by what its sensor shows."""

    machine: MachineWithTruth
    hitch: float
    """measured per true angle"""
    joint: float
    """the same"""
    limit: float
    """of the joint, rad"""

    def read(self) -> Measurement:
        seen = self.machine.read()
        hitch, joint = self.hitch * seen.hitch_angle, self.joint * seen.trailer_steering
        return replace(seen, hitch_angle=hitch, trailer_steering=joint)

    def write(self, command: Command) -> None:
        joint = max(-self.limit, min(command.trailer_steering / self.joint, self.limit))
        self.machine.write(replace(command, trailer_steering=joint))

    def truth(self) -> Truth:
        return self.machine.truth()

    def stop(self) -> None:
        self.machine.stop()


def simulation(changes: list[str], seed: int, *, hitch: float = 1.0, joint: float = 1.0) -> Simulation:
    """Return a run of the product on a machine with such sensors."""
    configuration = load_configuration("articulated", changes)
    made = Simulation(configuration, seed)
    made.machine = ScaledSensors(made.machine, hitch, joint, configuration.vehicle.trailer_steering_limit)
    return made
