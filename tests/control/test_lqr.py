import math
from dataclasses import replace

import numpy as np
import pytest
from controllers import LinearQuadraticRegulator
from scipy.linalg import expm

from drawbar.control.lqr import lqr_gain, path_dynamics
from drawbar.control.matrix_equations import regulator_gain
from drawbar.control.settings import LqrSettings
from drawbar.vehicle.parameters import VehicleParameters

VEHICLE, SAMPLE_TIME = VehicleParameters(), 0.2


def regulator(speed=1.0, **weights):
    return LinearQuadraticRegulator(VEHICLE, LqrSettings(model="lqr", **weights), SAMPLE_TIME, speed)


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.5])
def test_gain_tends_to_the_double_integrators_closed_form(speed):
    # e' = V h, h' = V / L_t v: the algebraic Riccati equation by hand
    lateral, heading, steering = 2.0, 3.0, 0.5
    A, B = path_dynamics(speed, VEHICLE.wheelbase, 1e-4)
    gain = regulator_gain(A, B, 1e-4 * np.diag([lateral, heading]), np.array([[1e-4 * steering]]))
    first = math.sqrt(lateral / steering)
    assert gain[0] == pytest.approx([first, math.sqrt(heading / steering + 2.0 * VEHICLE.wheelbase * first)], rel=1e-3)


@pytest.mark.parametrize("speed", [0.3, 1.0, 3.0])
def test_errors_move_as_the_matrix_exponential_says(speed):
    A, B = path_dynamics(speed, VEHICLE.wheelbase, SAMPLE_TIME)
    joint = expm(SAMPLE_TIME * speed * np.array([[0, 1, 0], [0, 0, 1 / VEHICLE.wheelbase], [0, 0, 0]]))
    assert np.hstack([A, B]) == pytest.approx(joint[:2], abs=1e-14)


@pytest.mark.parametrize("speed", [0.1, 1.0, 3.0])
@pytest.mark.parametrize("steering", [1e-3, 0.1, 10.0])
def test_the_loop_is_stable(speed, steering):
    A, B = path_dynamics(speed, VEHICLE.wheelbase, SAMPLE_TIME)
    gain = lqr_gain(VEHICLE, LqrSettings(model="lqr", steering=steering), SAMPLE_TIME, speed)
    assert np.abs(np.linalg.eigvals(A - B @ gain)).max() < 1.0


def test_small_errors_are_answered_by_the_gain(situation):
    law, gain = regulator(), lqr_gain(VEHICLE, LqrSettings(model="lqr"), SAMPLE_TIME, 1.0)
    for left, yaw in ((0.01, 0.0), (0.0, 0.01), (-0.02, 0.03)):
        here = situation(left=left, yaw=yaw)
        plan = law.feedback(here.estimate, here.reference)
        assert plan.tractor.steering == pytest.approx(-float(gain[0] @ (left, yaw)), abs=1e-12)


@pytest.mark.parametrize("left", [-50.0, -3.0, 3.0, 50.0])
def test_from_afar_the_path_is_approached_at_the_approach_angle(situation, left):
    # there lateral and heading error balance, however far it is
    here = situation(left=left, yaw=-math.copysign(0.4, left))
    plan = regulator(approach_angle=0.4).feedback(here.estimate, here.reference)
    assert plan.tractor.steering == pytest.approx(0.0, abs=1e-12)


def test_whole_turns_do_not_count(situation):
    here = situation(left=0.01, yaw=0.02)
    pose = here.estimate.tractor
    turned = replace(here.estimate, tractor=replace(pose, yaw=pose.yaw - 2.0 * math.pi))
    one, other = (regulator().feedback(e, here.reference).tractor.steering for e in (here.estimate, turned))
    assert other == pytest.approx(one, abs=1e-12)


def test_on_the_path_slips_and_curvature_are_fed_forward(situation):
    # on a circle the steering is that which holds it: tan(kappa delta + b) = L_t k + tan(alpha_r)
    slips = {"tractor_slip": 0.9, "steering_offset": 0.01, "tractor_crab": 0.02}
    here = situation(curvature=0.1, yaw=-0.02, **slips)
    delta = regulator().feedback(here.estimate, here.reference).tractor.steering
    assert math.tan(0.9 * delta + 0.01) == pytest.approx(VEHICLE.wheelbase * 0.1 + math.tan(0.02), abs=1e-12)


def test_curvature_is_read_ahead_by_the_lead(situation):
    here = situation()
    samples = here.reference.tractor.samples
    samples[:, 3] = 0.01 * np.arange(len(samples))
    for lead, curvature in ((0.0, 0.0), (0.4, 0.02), (0.5, 0.025), (10.0, 0.2)):
        delta = regulator(lead=lead).feedback(here.estimate, here.reference).tractor.steering
        assert math.tan(delta) == pytest.approx(VEHICLE.wheelbase * curvature, abs=1e-12)
