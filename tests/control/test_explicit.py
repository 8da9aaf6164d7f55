import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from alone import Alone
from controllers import LinearQuadraticRegulator, PurePursuit, VehicleController

from drawbar.codegen import Unit
from drawbar.control.settings import LqrSettings, PurePursuitSettings, TrailerProportionalIntegral
from drawbar.signals import SolverStatus
from drawbar.vehicle.parameters import VehicleParameters

SAMPLE_TIME, LIMIT = 0.2, 0.35
GAINS = TrailerProportionalIntegral(proportional=4.0, integral=2.0)
UNIT = """
#include "proportional_integral.h"
struct component { struct proportional_integral law; double error, output; };
#define COMPONENT_FIELDS \\
    SETTING(component, law.proportional, 0, 1, 0, 0) SETTING(component, law.integral, 0, 1, 0, 0) \\
    SETTING(component, law.interval, 0, 1, 0, 0) SETTING(component, law.limit, 0, 1, 0, 0) \\
    FIELD(component, error, 0, 1, 0, 0) FIELD(component, output, 0, 1, 0, 0)
int UNIT(answer)(struct component *component)
{
    component->output = proportional_integral(&component->law, component->error);
    return 0;
}
"""


def controllers(gains=GAINS, **vehicle) -> list[VehicleController]:
    parameters = VehicleParameters(**vehicle)
    return [
        PurePursuit(parameters, PurePursuitSettings(model="pure_pursuit", trailer=gains), SAMPLE_TIME),
        LinearQuadraticRegulator(parameters, LqrSettings(model="lqr", trailer=gains), SAMPLE_TIME, 1.0),
    ]


def plans(situation):
    return [controller.feedback(situation.estimate, situation.reference) for controller in controllers()]


def test_the_world_may_turn_and_shift(random_situations):
    for here in random_situations:
        for one, other in zip(plans(here), plans(here.turned(2.5, (40.0, -7.0))), strict=True):
            assert other.tractor.steering == pytest.approx(one.tractor.steering, abs=1e-12)
            assert other.trailer.steering == pytest.approx(one.trailer.steering, abs=1e-12)


def test_the_world_may_be_mirrored(random_situations):
    for here in random_situations:
        for one, other in zip(plans(here), plans(here.mirrored()), strict=True):
            assert other.tractor.steering == pytest.approx(-one.tractor.steering, abs=1e-12)
            assert other.trailer.steering == pytest.approx(-one.trailer.steering, abs=1e-12)


def test_an_error_to_the_left_steers_the_tractor_to_the_right_and_the_joint_to_the_left(situation):
    for plan in plans(situation(left=0.02)):
        assert -0.2 < plan.tractor.steering < -0.001
        assert plan.trailer.steering == pytest.approx((4.0 + 2.0 * SAMPLE_TIME) * 0.02)


def test_a_reversed_joint_is_commanded_reversed(situation):
    here = situation(left=0.02)
    for plain, reverse in zip(controllers(), controllers(joint_sign=-1), strict=True):
        one, other = (c.feedback(here.estimate, here.reference).trailer for c in (plain, reverse))
        assert other.steering == -one.steering
        assert (other.steerings == one.steerings).all()


def test_commands_end_at_their_limits_and_what_is_no_number_stays_none(situation):
    for controller in controllers():
        far = situation(left=3.0, yaw=0.9)
        plan = controller.feedback(far.estimate, far.reference)
        assert plan.tractor.steering == -VehicleParameters().tractor_steering_limit
        assert plan.trailer.steering == VehicleParameters().trailer_steering_limit
        nowhere = replace(far.estimate, tractor=replace(far.estimate.tractor, y=math.nan))
        assert math.isnan(controller.feedback(nowhere, far.reference).tractor.steering)


def test_the_prediction_is_the_bicycles_arc(situation):
    here = situation(curvature=0.1, left=0.3, yaw=0.2, speed=1.2, longitudinal_slip=0.9)
    for controller in controllers():
        plan = controller.feedback(here.estimate, here.reference)
        x, y, yaw = here.estimate.tractor.x, here.estimate.tractor.y, here.estimate.tractor.yaw
        speed, step = 1.2 * 0.9, SAMPLE_TIME / 1000
        turn = speed * math.tan(plan.tractor.steering) / 1.4
        for pose in plan.tractor.poses:
            assert pose == pytest.approx([x, y, yaw], abs=1e-6)
            for _ in range(1000):
                middle = yaw + 0.5 * step * turn
                x, y, yaw = x + step * speed * math.cos(middle), y + step * speed * math.sin(middle), yaw + step * turn
        assert (plan.trailer.poses == here.reference.trailer.samples[:, :3]).all()
        assert plan.tractor.status is plan.trailer.status is SolverStatus.SOLVED


def test_without_gains_the_joint_is_held_straight(situation):
    for controller in controllers(TrailerProportionalIntegral()):
        here = situation(left=0.5)
        assert controller.feedback(here.estimate, here.reference).trailer.steering == 0.0


def proportional_integral(**gains: float) -> Callable[[float], float]:
    """Return a function from the lateral error (m) of each sample to the joint angle (rad)."""
    settings = {"law.interval": SAMPLE_TIME, "law.limit": LIMIT, **{f"law.{name}": gains[name] for name in gains}}
    law = Alone(Unit(name="joint", source=UNIT, configure=lambda workspace: workspace.write(settings)))

    def output(error: float) -> float:
        law.live.array("error")[0] = error
        law.call("answer")
        return float(law.live.array("output")[0])

    return output


def test_the_sum_is_the_textbooks():
    output = proportional_integral(proportional=4.0, integral=2.0)
    errors = 0.02 * np.sin(np.arange(30))
    outputs = [output(float(error)) for error in errors]
    assert outputs == pytest.approx(4.0 * errors + 2.0 * SAMPLE_TIME * np.cumsum(errors), abs=1e-15)


def test_the_integral_rests_at_the_limit_and_comes_back_at_once():
    output = proportional_integral(proportional=4.0, integral=2.0)
    assert [output(0.2) for _ in range(500)] == [LIMIT] * 500
    assert output(0.0) < LIMIT  # the proportional part is gone, and no more has been gathered than fits
    assert output(-0.2) < 0.0


def test_the_integral_leaves_the_limit_from_beyond():
    output = proportional_integral(integral=2.0)
    for _ in range(100):
        output(0.01)
    full = output(0.01)
    assert full == pytest.approx(LIMIT, abs=2.0 * SAMPLE_TIME * 0.01)
    assert output(-0.01) < full


def test_the_integral_removes_a_steady_error():
    # docs/theory/vehicle-models.md, straight line: y' = -V / (L_i + d) (y - y_0 + d delta), y_0 the error at the start
    output = proportional_integral(proportional=10.0, integral=10.0)
    y = shift = 0.04
    for _ in range(300):
        y += SAMPLE_TIME / 1.5 * (shift - 0.2 * output(y) - y)
    assert abs(y) < 1e-4
