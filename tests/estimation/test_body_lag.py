"""By how much the tractor turns later than its wheels stand: against masses and tyres, and by speed and ground."""

from dataclasses import replace

import numpy as np
import pytest
from estimators import DeadTimePredictor
from scipy.integrate import solve_ivp

from drawbar.geometry import GRAVITY
from drawbar.signals import Estimate, Pose, SolverStatus
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.parameters import VehicleParameters

VEHICLE = VehicleParameters()
ESTIMATE = Estimate(
    time=3.0,
    tractor=Pose(x=0.0, y=0.0, yaw=0.0),
    trailer=Pose(x=-2.0, y=0.0, yaw=0.0),
    hitch_angle=0.0,
    speed=1.0,
    tractor_steering=0.0,
    trailer_steering=0.0,
    longitudinal_slip=1.0,
    tractor_slip=1.0,
    trailer_slip=1.0,
    steering_offset=0.0,
    tractor_crab=0.0,
    trailer_crab=0.0,
    status=SolverStatus.SOLVED,
)
HARDLY = 1e-9
"""s^2/m; a firm ground on which the tractor turns nearly as its wheels stand"""


def lag(speed: float, creep: float, per_speed: float, slip: float = 1.0) -> float:
    """Return the time by which estimates are moved forward where commands have no dead time, s."""
    ahead = DeadTimePredictor(VEHICLE, articulated(VEHICLE), 0.2, per_speed)
    estimate = replace(ESTIMATE, speed=speed, longitudinal_slip=slip, creep=creep)
    return ahead.ahead(estimate).time - estimate.time


@pytest.mark.parametrize(
    ("speed", "creep", "per_speed", "slip", "expected"),
    [
        (2.0, 0.0, 0.03, 1.0, 0.06),
        (2.5, 0.0, 0.03, 0.8, 0.06),
        (2.0, 0.2, 0.03, 1.0, 0.06 + 0.8 / GRAVITY),
        (4.0, 1.0, 0.1, 1.0, 0.3),  # no estimate makes plans begin further ahead
        (2.0, -1.0, 0.03, 1.0, 0.0),
        (2.0, 0.3, 0.0, 1.0, 0.0),
        (0.0, 0.3, 0.03, 1.0, 0.0),
    ],
)
def test_the_lag_grows_with_speed_and_with_what_the_ground_gives_way(speed, creep, per_speed, slip, expected) -> None:
    assert lag(speed, creep, per_speed, slip) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize(("speed", "creep"), [(1.0, 0.3), (2.8, 0.36), (3.0, 0.05)])
def test_ground_that_creeps_delays_the_path_of_the_rear_axle_as_masses_and_tyres_do(speed, creep) -> None:
    """A single-track vehicle on tyres whose slip angle is `creep` times side force per load, wheels turned steadily."""
    wheelbase, front, turning = VEHICLE.wheelbase, 0.6 * VEHICLE.wheelbase, 0.01  # m, m, rad/s
    rear = wheelbase - front
    loads = GRAVITY * rear / wheelbase, GRAVITY * front / wheelbase  # per mass: of front and rear axle

    def forces(t: float, aside: float, turn: float) -> tuple[float, float]:
        slips = turning * t - (aside + front * turn) / speed, -(aside - rear * turn) / speed
        return loads[0] * slips[0] / creep, loads[1] * slips[1] / creep

    def rates(t: float, state: np.ndarray) -> list[float]:
        ahead, behind = forces(t, *state)
        inertia = front * rear  # per mass
        return [ahead + behind - speed * state[1], (front * ahead - rear * behind) / inertia]

    end = 3.0
    aside, turn = solve_ivp(rates, (0.0, end), [0.0, 0.0], method="Radau", rtol=1e-9, atol=1e-12).y[:, -1]
    pushed, turned = rates(end, np.array([aside, turn]))
    at_rear_axle = pushed + speed * turn - rear * turned  # its acceleration to the left, m/s^2
    late = end - at_rear_axle * wheelbase / (speed**2 * turning)
    assert lag(speed, creep, HARDLY) == pytest.approx(late, abs=1e-4)
