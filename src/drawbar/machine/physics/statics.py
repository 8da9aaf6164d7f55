"""Statics: the load of each wheel while the machine stands on level ground, by moments about RJ1 and the rear axle."""

from drawbar.geometry import GRAVITY
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.vehicle.parameters import VehicleParameters


def static_loads(vehicle: VehicleParameters, settings: PhysicsMachineSettings) -> tuple[float, float, float]:
    """Return the load of one wheel of rear, front and trailer axle, N, or symbols where the numbers are symbols."""
    tractor, trailer = settings.tractor, settings.trailer
    behind = vehicle.drawbar_length + vehicle.trailer_length
    of_frame = trailer.mass * (behind - trailer.ahead) / behind
    of_drawbar = trailer.drawbar_mass * 0.5 * vehicle.drawbar_length / behind
    axle = of_frame + of_drawbar
    hitch = trailer.mass + trailer.drawbar_mass - axle
    front = (tractor.mass * tractor.ahead - hitch * vehicle.free_joint_offset) / vehicle.wheelbase
    rear = tractor.mass + hitch - front
    return 0.5 * GRAVITY * rear, 0.5 * GRAVITY * front, 0.5 * GRAVITY * axle
