"""Physics machines without sensor errors; all of it is skipped without MuJoCo."""

from collections.abc import Callable
from typing import Any

import pytest

from drawbar.machine.physics.machine import PhysicsMachine
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.signals import Pose
from drawbar.vehicle.parameters import VehicleParameters

EXACT = {"position": 0.0, "hitch_angle": 0.0, "speed": 0.0, "steering_resolution": 1e-12}


@pytest.fixture(scope="session", autouse=True)
def engine() -> None:
    pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install 'drawbar[physics]'")


@pytest.fixture(scope="session")
def build() -> Callable[..., PhysicsMachine]:
    """Return a function that makes a machine with exact sensors; sections of its settings are given by name."""

    def build(
        *, vehicle: VehicleParameters | None = None, yaw: float = 0.0, seed: int = 0, **sections: Any
    ) -> PhysicsMachine:
        return PhysicsMachine(
            vehicle=vehicle or VehicleParameters(),
            settings=PhysicsMachineSettings.model_validate({"sensors": EXACT} | sections),
            sample_time=0.2,
            start=Pose(x=0.0, y=0.0, yaw=yaw),
            seed=seed,
        )

    return build
