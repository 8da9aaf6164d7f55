"""The chain keeps the axles' rolling constraints and equals the closed form of docs/theory/vehicle-models.md."""

import math
from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.machine.chain import chain_rates, trailer_axle
from drawbar.vehicle.parameters import VehicleParameters

VEHICLE = VehicleParameters()
RNG = np.random.default_rng(20)
# columns: x, y, theta, psi, joint | joint rate | speed | wheel angle | alpha_r, alpha_i
SPREAD = np.array([50.0, 50.0, 4.0, 4.0, 0.55, 0.4, 2.0, 0.6, 0.1, 0.1])
CASES = SPREAD * RNG.uniform(-1.0, 1.0, (200, 10))


def compiled(output: Callable[..., ca.SX]) -> Callable[..., Floats]:
    sizes = (5, 1, 1, 1, 2)
    symbols = [ca.SX.sym("s", size) for size in sizes]
    function = ca.Function("f", symbols, [output(*symbols)])
    return lambda case: np.asarray(function(*np.split(case, np.cumsum(sizes)[:-1]))).ravel()


rates = compiled(lambda *arguments: chain_rates(VEHICLE, *arguments))
axle = compiled(lambda pose, *_: trailer_axle(VEHICLE, pose))


def moved(case: Floats, time: float) -> Floats:
    """The case after it kept its rates for a time."""
    return case + time * np.concatenate([rates(case), np.zeros(5)])


@pytest.mark.parametrize("case", CASES)
def test_trailer_axle_slides_only_by_its_crab_angle(case: Floats) -> None:
    step = 1e-5
    velocity = (axle(moved(case, step)) - axle(moved(case, -step))) / (2.0 * step)
    psi, crab = case[3], case[9]
    along = velocity @ (math.cos(psi), math.sin(psi))
    across = velocity @ (-math.sin(psi), math.cos(psi))
    assert across == pytest.approx(along * math.tan(crab), abs=1e-9)


@pytest.mark.parametrize("case", CASES)
def test_rear_axle_slides_only_by_its_crab_angle(case: Floats) -> None:
    theta, speed, crab = case[2], case[6], case[8]
    along, across = rates(case)[:2] @ np.array(
        [[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]]
    )
    assert along == pytest.approx(speed, abs=1e-12)
    assert across == pytest.approx(speed * math.tan(crab), abs=1e-12)


@pytest.mark.parametrize("case", CASES)
def test_yaw_rates_equal_the_closed_form(case: Floats) -> None:
    theta, psi, J, J_rate, V, wheel, alpha_r, alpha_i = case[2:]
    a, d, L_i = VEHICLE.free_joint_offset, VEHICLE.drawbar_length, VEHICLE.trailer_length
    omega = V * (math.tan(wheel) - math.tan(alpha_r)) / VEHICLE.wheelbase
    gamma, W = theta - psi, V * math.tan(alpha_r) - a * omega
    sine, cosine, crab = math.sin(gamma), math.cos(gamma), math.tan(alpha_i)
    turning = V * sine + W * cosine - d * J_rate * math.cos(J)
    sliding = crab * (V * cosine - W * sine + d * J_rate * math.sin(J))
    psi_rate = (turning - sliding) / (L_i + d * math.cos(J) + crab * d * math.sin(J))
    assert rates(case)[2:] == pytest.approx([omega, psi_rate, J_rate], abs=1e-11)


@pytest.mark.parametrize("case", CASES[:20])
def test_rotated_and_shifted_world_turns_alike(case: Floats) -> None:
    turn = 2.1
    other = case.copy()
    other[:4] += 30.0, -7.0, turn, turn
    rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    assert rates(other)[2:] == pytest.approx(rates(case)[2:], abs=1e-12)
    assert rates(other)[:2] == pytest.approx(rotation @ rates(case)[:2], abs=1e-12)


@pytest.mark.parametrize("case", CASES[:20])
def test_mirrored_world_turns_the_other_way(case: Floats) -> None:
    mirror = np.array([1.0, -1.0, -1.0, -1.0, -1.0, -1.0, 1.0, -1.0, -1.0, -1.0])
    assert rates(mirror * case) == pytest.approx(mirror[:5] * rates(case), abs=1e-12)
