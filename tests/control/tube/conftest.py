"""The tubes of both models under declared bounds, and what a test needs to leave a set by."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from drawbar.control.settings import (
    ArticulatedControllerSettings,
    BodyTubeSettings,
    TricycleControllerSettings,
    TubeOperatingRange,
    TubeSettings,
)
from drawbar.control.tube.bodies import Body, OperatingConditions
from drawbar.control.tube.error_model import Source
from drawbar.control.tube.invariant_set import InvariantSet
from drawbar.control.tube.tube import bodies_of
from drawbar.geometry import Floats
from drawbar.vehicle.parameters import VehicleParameters

NAMES = ("tractor", "trailer")
CONTROLLERS = {
    "articulated": ArticulatedControllerSettings(model="articulated"),
    "tricycle": TricycleControllerSettings(model="tricycle"),
}
DECLARED = {
    ("articulated", "tractor"): BodyTubeSettings(
        lqr={"lateral": 1.0, "yaw": 1.0, "command": 5.0},
        disturbances={"steering_offset": 0.01, "tractor_crab": 0.01, "speed": 0.05, "steering_rate": 0.1},
        estimation={"lateral": 0.02, "yaw": 0.01, "steering": 0.01},
    ),
    ("articulated", "trailer"): BodyTubeSettings(
        articulation=-0.3,
        disturbances={"tractor_yaw_rate": 0.05, "trailer_crab": 0.01, "steering_rate": 0.1},
        estimation={"articulation": 0.01, "steering": 0.01},
    ),
    ("tricycle", "tractor"): BodyTubeSettings(
        lateral=-0.8, yaw=-1.6, disturbances={"yaw_rate": 0.02, "lateral_rate": 0.01}, estimation={"yaw": 0.01}
    ),
    ("tricycle", "trailer"): BodyTubeSettings(
        lateral=-0.8, yaw=-1.6, disturbances={"coupling": 0.02, "hitch_angle": 0.01}, estimation={"lateral": 0.02}
    ),
}


@pytest.fixture(scope="session")
def body() -> Callable[..., Body]:
    """Return a function that gives the body of a model by name, over an operating range."""

    def body(model: str, name: str, ranges: TubeOperatingRange | None = None, **vehicle: float) -> Body:
        ranges = ranges or TubeOperatingRange(speed=(0.9, 1.0), tractor_slip=(0.9, 1.0), trailer_slip=(0.9, 1.0))
        conditions = OperatingConditions(
            vehicle=VehicleParameters(**vehicle), ranges=ranges, speed=1.0, sample_time=0.2
        )
        tube = TubeSettings(tractor=DECLARED["articulated", "tractor"], trailer=DECLARED["articulated", "trailer"])
        return bodies_of(CONTROLLERS[model], conditions, tube)[NAMES.index(name)]

    return body


@pytest.fixture(scope="session")
def declared() -> Mapping[tuple[str, str], BodyTubeSettings]:
    """Return bounds and gains that leave something of every bound, by model and body."""
    return DECLARED


@pytest.fixture(scope="session")
def furthest() -> Callable[[Source, Floats], Floats]:
    """Return a function that gives the points (m, n) of a source's set that are furthest in directions (m, n)."""
    return _furthest


@pytest.fixture(scope="session")
def boundary() -> Callable[[InvariantSet, Floats], Floats]:
    """Return a function that gives the points (m, b) of an invariant set that are furthest in directions (m, b)."""

    def boundary(around: InvariantSet, directions: Floats) -> Floats:
        points = np.zeros_like(directions)
        for power in around.powers:
            points += sum(_furthest(source, directions @ power) for source in around.sources) @ power.T
        pulled = directions @ around.ball
        ball = pulled / np.linalg.norm(pulled, axis=1, keepdims=True) * around.radii.sum()
        return points + ball @ around.ball.T

    return boundary


@pytest.fixture(scope="session")
def scattered() -> Callable[..., Floats]:
    """Return a function that gives directions (m, n) all around, for coordinates of these scales (n,)."""

    def scattered(seed: int, count: int, scales: Floats) -> Floats:
        n = len(scales)
        others = np.random.default_rng(seed).normal(size=(count - 2 * n, n))
        return np.vstack([np.eye(n), -np.eye(n), others]) / scales

    return scattered


def _furthest(source: Source, directions: Floats) -> Floats:
    products = np.einsum("mn,vgn->mvg", directions, source.generators)
    best = np.abs(products).sum(axis=2).argmax(axis=1)
    signs = np.sign(products[np.arange(len(directions)), best])
    return source.bound * np.einsum("mg,mgn->mn", signs, source.generators[best])
