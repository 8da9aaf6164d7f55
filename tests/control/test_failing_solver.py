"""What becomes of the plans when a solver fails, and when a sample is left out: in both structures, of both models."""

import math

import numpy as np
import pytest
from controllers import (
    ArticulatedTractor,
    ArticulatedTrailer,
    CentralisedArticulated,
    CentralisedTricycle,
    DecentralisedController,
    TricycleTractor,
    TricycleTrailer,
)

from drawbar.control.settings import ArticulatedControllerSettings, TricycleControllerSettings
from drawbar.signals import SolverStatus
from drawbar.vehicle.parameters import VehicleParameters

BODIES, HORIZON, SAMPLE_TIME = ("tractor", "trailer"), 20, 0.2
KINDS = {
    "tricycle": (CentralisedTricycle, TricycleTractor, TricycleTrailer),
    "articulated": (CentralisedArticulated, ArticulatedTractor, ArticulatedTrailer),
}


@pytest.fixture(params=["decentralised", "centralised"])
def new(request, untightened, name):
    """Return a function that makes a controller of both bodies, and the solvers that it has."""

    def new(**vehicle):
        parameters = VehicleParameters(**vehicle)
        kind = TricycleControllerSettings if name == "tricycle" else ArticulatedControllerSettings
        settings = kind(model=name, horizon=HORIZON)
        tubes, (whole, tractor, trailer) = untightened(settings, parameters), KINDS[name]
        if request.param == "centralised":
            controller = whole(parameters, settings, SAMPLE_TIME, tubes)
            return controller, [controller]
        pair = (
            tractor(parameters, settings, SAMPLE_TIME, tubes.tractor),
            trailer(parameters, settings, SAMPLE_TIME, tubes.trailer),
        )
        return DecentralisedController(*pair), pair

    return new


def plans(controller, situation):
    """Return both bodies' plans of one sample, ready for the next."""
    plan = controller.feedback(situation.estimate, situation.reference)
    controller.prepare()
    return plan.tractor, plan.trailer


def solved(controller, situation):
    """Return the plans of a third sample on a curve beside the path: no two planned steerings are the same."""
    for k in range(3):
        made = plans(controller, situation(left=0.1, yaw=0.05, curvature=0.08, ahead=0.2 * k))
    assert all(plan.status is SolverStatus.SOLVED for plan in made)
    assert all(np.abs(np.diff(plan.steerings[:6])).min() > 1e-6 for plan in made)
    return made


def test_while_the_solver_fails_the_planned_steerings_are_commanded_one_after_the_other(new, situation):
    controller, _ = new()
    last = solved(controller, situation)
    for k in range(1, HORIZON + 5):
        there = situation(left=0.15, curvature=0.08, ahead=0.4 + 0.2 * k).nowhere()
        for now, before in zip(plans(controller, there), last, strict=True):
            left = max(HORIZON - k, 1)
            assert now.status in (SolverStatus.BAD_INPUT, SolverStatus.CHECK_FAILED)
            assert now.steering == before.steerings[-left]
            assert now.steerings[:left].tolist() == before.steerings[-left:].tolist()
            assert set(now.steerings[left:].tolist()) <= {before.steerings[-1]}  # the end is repeated
            rows = max(HORIZON + 1 - k, 1)
            assert now.poses[:rows].tolist() == before.poses[-rows:].tolist()
            assert (now.poses[rows:] == before.poses[-1]).all()
            assert now.deviation.tolist() == [0.0] * now.deviation.size
            assert now.deviation.size > 0


@pytest.mark.parametrize("part", ["speed", "longitudinal_slip"])
def test_an_estimate_that_is_not_finite_is_lived_through_as_well(new, situation, part):
    controller, _ = new()
    last = solved(controller, situation)
    for k in range(1, 4):
        made = plans(controller, situation(ahead=0.4 + 0.2 * k, **{part: math.nan}))
        for now, before in zip(made, last, strict=True):
            assert now.status is not SolverStatus.SOLVED
            assert now.steering == before.steerings[k]
            assert now.deviation.tolist() == [0.0] * now.deviation.size


def test_a_solver_that_works_again_plans_from_the_estimate(new, situation):
    controller, _ = new()
    solved(controller, situation)
    plans(controller, situation(ahead=0.6).nowhere())
    there = situation(left=0.2, ahead=0.8)
    for now, body in zip(plans(controller, there), BODIES, strict=True):
        pose = getattr(there.estimate, body)
        assert now.status is SolverStatus.SOLVED
        assert now.poses[0] == pytest.approx([pose.x, pose.y, pose.yaw], abs=1e-9)
        assert now.deviation == pytest.approx(np.zeros(now.deviation.size), abs=1e-12)  # nothing foretold where it is


def test_before_any_plan_was_solved_one_that_failed_begins_at_the_estimate(new, situation):
    controller, _ = new()
    for k in range(2):
        one = situation(left=0.3, ahead=0.2 * k).nowhere()
        for plan, body in zip(plans(controller, one), BODIES, strict=True):
            pose = getattr(one.estimate, body)
            assert plan.status is not SolverStatus.SOLVED
            assert plan.poses[0] == pytest.approx([pose.x, pose.y, pose.yaw], abs=1e-9)
            assert plan.deviation == pytest.approx(np.zeros(plan.deviation.size), abs=1e-12)


@pytest.mark.parametrize("name", ["articulated"], scope="session")
def test_a_reversed_joint_is_told_the_planned_angle_reversed(new, situation):
    controller, _ = new(joint_sign=-1)
    _, last = solved(controller, situation)
    for k in range(1, 4):
        assert plans(controller, situation().nowhere())[1].steering == -last.steerings[k]


def test_samples_left_out_move_the_plan_on(new, situation):
    controller, solvers = new()
    solved(controller, situation)
    before = [(each.solver.x.copy(), each.solver.u.copy()) for each in solvers]
    for each, (x, u) in zip(solvers, before, strict=True):
        each.skip(2)
        assert each.solver.x[:-2].tolist() == x[2:].tolist()
        assert each.solver.u[:-2].tolist() == u[2:].tolist()


def test_after_a_sample_left_out_nothing_is_held_against_the_vehicle_and_the_plan_is_as_good(new, situation):
    (late, parts), (other, _) = new(), new()
    for controller in (late, other):
        for k in range(3):
            plans(controller, situation(left=0.02, ahead=0.2 * k))
    for each in parts:
        each.skip()
    plans(other, situation(left=0.018, ahead=0.6))
    there = situation(left=0.016, ahead=0.8)
    for now, then in zip(plans(late, there), plans(other, there), strict=True):
        assert now.status is SolverStatus.SOLVED
        assert np.abs(then.deviation).max() > 1e-3
        assert now.deviation == pytest.approx(np.zeros(now.deviation.size), abs=1e-12)
        assert now.steerings == pytest.approx(then.steerings, abs=0.02)


def test_a_plan_that_is_lived_on_is_as_old_as_the_samples_left_out(new, situation):
    controller, parts = new()
    last = solved(controller, situation)
    for each in parts:
        each.skip()
    for now, before in zip(plans(controller, situation(ahead=0.8).nowhere()), last, strict=True):
        assert now.steering == before.steerings[2]
