"""World: what the receivers of a stand-in measure of its motion."""

import math

import pytest

from drawbar.config import load_configuration
from drawbar.machine.stand_in.world import TICK, World
from drawbar.signals import Command, Measurement, Pose, Truth

TURNING = 0.2
RADII = {"tractor": 10.0, "trailer": 8.0}


class Turning:
    """Two bodies that turn about one centre, on circles of their own."""

    def __init__(self) -> None:
        self.time = 0.0

    def read(self) -> Measurement:
        names = ("tractor_x", "tractor_y", "trailer_x", "trailer_y", "hitch_angle", "speed")
        unknown = dict.fromkeys((*names, "tractor_steering", "trailer_steering"), math.nan)
        return Measurement(time=self.time, **unknown)

    def write(self, command: Command) -> None:
        self.time += TICK

    def stop(self) -> None:
        pass

    def truth(self) -> Truth:
        angle = TURNING * self.time
        bodies = {
            body: Pose(x=radius * math.sin(angle), y=-radius * math.cos(angle), yaw=angle)
            for body, radius in RADII.items()
        }
        names = ("tractor_steering", "trailer_steering", "tractor_slip", "steering_offset", "tractor_crab")
        still = dict.fromkeys((*names, "trailer_crab"), 0.0)
        return Truth(time=self.time, **bodies, speed=2.2, longitudinal_slip=0.9, **still)


@pytest.mark.parametrize("body", list(RADII))
def test_each_receiver_measures_the_velocity_of_its_own_antenna(body: str) -> None:
    vehicle = load_configuration("articulated", ["vehicle.masts.trailer.left=1.0"]).vehicle
    world = World(Turning(), vehicle)
    for _ in range(50):
        world.tick(0.0, 0.0, 2.2)
    speed, course = world.velocity(body)
    radius = RADII[body] - (1.0 if body == "trailer" else 0.0)
    assert speed == pytest.approx(TURNING * radius, rel=1e-4)
    assert course == pytest.approx(TURNING * (world.truth.time - 0.5 * TICK), abs=1e-4)


def test_antennas_of_a_vehicle_that_stands_have_no_velocity() -> None:
    assert World(Turning(), load_configuration("articulated").vehicle).velocity("tractor") == (0.0, 0.0)
