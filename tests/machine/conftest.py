"""The machines these tests drive: an ideal one without randomness, and shorthands to move it."""

from collections.abc import Callable

import pytest

from drawbar.machine.sensor_settings import SensorSettings
from drawbar.machine.settings import CrabProcess, GroundSettings, SimulatedMachineSettings, SlipProcess
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Command, Pose, Truth
from drawbar.vehicle.parameters import VehicleParameters

SAMPLE_TIME = 0.2


@pytest.fixture(scope="session")
def firm_ground() -> GroundSettings:
    firm, straight = SlipProcess(mean=1.0, deviation=0.0), CrabProcess(deviation=0.0)
    return GroundSettings(longitudinal_slip=firm, tractor_slip=firm, tractor_crab=straight, trailer_crab=straight)


@pytest.fixture(scope="session")
def ideal(firm_ground: GroundSettings) -> SimulatedMachineSettings:
    """No slip, no noise, and steering readings as fine as a double allows."""
    sensors = SensorSettings(position=0.0, hitch_angle=0.0, speed=0.0, steering_resolution=1e-12)
    return SimulatedMachineSettings(ground=firm_ground, sensors=sensors)


@pytest.fixture(scope="session")
def build() -> Callable[..., SimulatedMachine]:
    def build(
        settings: SimulatedMachineSettings,
        *,
        vehicle: VehicleParameters | None = None,
        start: Pose | None = None,
        seed: int = 0,
    ) -> SimulatedMachine:
        return SimulatedMachine(
            vehicle=vehicle or VehicleParameters(),
            settings=settings,
            sample_time=SAMPLE_TIME,
            start=start or Pose(x=0.0, y=0.0, yaw=0.0),
            seed=seed,
        )

    return build


@pytest.fixture(scope="session")
def drive() -> Callable[..., list[Truth]]:
    """Return a function that holds one command for some samples and returns the truth after each."""

    def drive(
        machine: SimulatedMachine,
        samples: int,
        *,
        tractor: float = 0.0,
        trailer: float = 0.0,
        speed: float = 1.0,
    ) -> list[Truth]:
        run = []
        if not machine._begun:
            machine.read()  # where it was placed
        for _ in range(samples):
            time = machine.truth().time
            machine.write(Command(time=time, tractor_steering=tractor, trailer_steering=trailer, speed=speed))
            machine.read()
            run.append(machine.truth())
        return run

    return drive
