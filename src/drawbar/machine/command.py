"""Command, as a machine in a computer accepts it."""

from drawbar.errors import HardwareError
from drawbar.signals import Command
from drawbar.vehicle.parameters import VehicleParameters


def accepted(command: Command, vehicle: VehicleParameters, full_speed: float) -> tuple[float, float, float]:
    """Return what the actuators are commanded: angle of the front wheels and of the joint (rad), wheel speed (m/s).

    Raises HardwareError when the command is not finite or beyond the limits.
    """
    _within("tractor_steering", command.tractor_steering, vehicle.tractor_steering_limit, "rad")
    _within("trailer_steering", command.trailer_steering, vehicle.trailer_steering_limit, "rad")
    _within("speed", command.speed, full_speed, "m/s")
    return command.tractor_steering, vehicle.joint_sign * command.trailer_steering, command.speed


def _within(name: str, value: float, limit: float, unit: str) -> None:
    """Refuse a command beyond ±limit, or not a number."""
    if not (abs(value) <= limit):
        raise HardwareError(
            f"the simulated machine was commanded {name} = {value} {unit}; it accepts finite values within "
            f"±{limit:.6g} {unit}. Pass commands through the command gate, or change the limits"
        )
