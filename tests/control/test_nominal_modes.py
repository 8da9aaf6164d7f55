"""Where a body's problem starts in each of the three modes, sample after sample, without a simulation around it."""

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from controllers import ArticulatedTractor, ArticulatedTrailer, TricycleTractor

from drawbar.control.settings import (
    ArticulatedControllerSettings,
    BodyTubeSettings,
    Nominal,
    SharingSettings,
    TricycleControllerSettings,
    TubeSettings,
)
from drawbar.control.tube.inner_box import initial_choice
from drawbar.control.tube.tube import tubes_of
from drawbar.signals import SolverStatus
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.parameters import VehicleParameters

VEHICLE, SAMPLE_TIME = VehicleParameters(), 0.2
PRODUCT = ArticulatedControllerSettings(model="articulated", sharing=SharingSettings(share=0.0, widening=0.0))
PAPER = TricycleControllerSettings(model="tricycle")
TRACTOR = {"lqr": {"lateral": 1.0, "yaw": 1.0, "command": 5.0}, "disturbances": {"tractor_crab": 0.02}}
NARROW = {"speed": (0.99, 1.0), "tractor_slip": (0.99, 1.0)}
TRAILER = {"articulation": -0.3, "disturbances": {"trailer_crab": 0.02}}


def tubes(nominal, settings=PRODUCT, tractor=TRACTOR, trailer=TRAILER):
    tube = TubeSettings(
        nominal=nominal,
        tractor=BodyTubeSettings(**tractor),
        trailer=BodyTubeSettings(**trailer),
        operating_range=NARROW,
    )
    return tubes_of(VEHICLE, settings, tube, speed=1.0, sample_time=SAMPLE_TIME)


def body(situation, name):
    return getattr(situation.reference, name)


def step(controller, situation, name="tractor"):
    plan = controller.feedback(situation.estimate, body(situation, name))
    controller.prepare()
    return plan


def successor(controller):
    """Return where the controller's nominal model got to (nx,), in the frame in which it is remembered."""
    return controller.live.array("subsystem.successor").copy()


def placed_successor(controller):
    """Return where the nominal model of a controller that optimises its first state got to (nx,), in the world."""
    x, y, yaw = controller.live.array("subsystem.frame").tolist()
    ahead, left, *rest = successor(controller).tolist()
    world = complex(x, y) + complex(ahead, left) * complex(math.cos(yaw), math.sin(yaw))
    return np.array([world.real, world.imag, rest[0] + yaw, *rest[1:]])


def test_the_first_sample_has_nothing_to_be_held_to(situation):
    for nominal in Nominal:
        one = situation(left=0.01, yaw=0.005)
        plan = step(ArticulatedTractor(VEHICLE, PRODUCT, SAMPLE_TIME, tubes(nominal).tractor), one)
        assert plan.status is SolverStatus.SOLVED
        limit = initial_choice(tubes(nominal).tractor) if nominal is Nominal.OPTIMISED else np.zeros(3)
        assert (np.abs(plan.deviation) <= limit + 1e-12).all()


def test_predicted_starts_at_the_estimate_and_holds_to_the_prediction(situation):
    controller = ArticulatedTractor(VEHICLE, PRODUCT, SAMPLE_TIME, tubes(Nominal.PREDICTED).tractor)
    first, second = situation(left=0.1), situation(left=0.12, ahead=0.2, yaw=0.02)
    step(controller, first)
    predicted = successor(controller)
    plan = step(controller, second)
    pose = second.estimate.tractor
    assert plan.poses[0] == pytest.approx([pose.x, pose.y, pose.yaw], abs=1e-12)
    assert plan.deviation[0] == pytest.approx(pose.y - predicted[1], abs=1e-4)  # the path is straight and east
    assert plan.deviation[1] == pytest.approx(pose.yaw - predicted[2], abs=1e-12)


def test_propagated_follows_its_own_model_whatever_the_estimate_says(situation, nominal_states):
    controller = ArticulatedTractor(VEHICLE, PRODUCT, SAMPLE_TIME, tubes(Nominal.PROPAGATED).tractor)
    step(controller, situation(left=0.1))
    for k in range(1, 5):
        follows = successor(controller)
        seen = situation(left=0.1 + 0.02 * k, ahead=0.2 * k + 0.05, yaw=0.01 * k)
        plan = step(controller, seen)
        beside = nominal_states.beside(follows, body(seen, "tractor").closest)
        assert plan.poses[0] == pytest.approx(beside[:3], abs=1e-12)
        assert np.hypot(*(plan.poses[0, :2] - follows[:2])) < 0.2  # moved along the path only
        assert plan.deviation[0] == pytest.approx(0.1 + 0.02 * k - follows[1], abs=1e-3)


def test_the_nominal_model_gets_what_is_really_commanded(situation):
    # far beside the path the planned command is cut at what the tube leaves; the rate that follows is smaller
    tube = tubes(Nominal.PROPAGATED).tractor
    controller = ArticulatedTractor(VEHICLE, PRODUCT, SAMPLE_TIME, tube)
    limit = tube.bounds["command"].tightened
    plan = step(controller, situation(left=3.0, tractor_steering=-0.98 * limit))
    assert plan.steering == pytest.approx(-limit, abs=1e-12)
    share = 1.0 - math.exp(-SAMPLE_TIME / VEHICLE.steering_lag)
    assert successor(controller)[3] == pytest.approx(-0.98 * limit - share * 0.02 * limit, abs=1e-12)
    assert plan.steering + 0.0 >= -VEHICLE.tractor_steering_limit + 1e-3


def test_the_successor_is_the_models_next_state_and_moves_no_plan(situation):
    controller = ArticulatedTractor(VEHICLE, PRODUCT, SAMPLE_TIME, tubes(Nominal.PROPAGATED).tractor)
    one, solver = situation(left=0.1, curvature=0.1), controller.solver
    controller.feedback(one.estimate, body(one, "tractor"))
    model = solver.problem.model
    step_of_model = ca.Function("F", [model.x, model.u, model.p], [integrate(model, SAMPLE_TIME)])
    expected = np.array(step_of_model(solver.x[0], solver.u[0], solver.p[0])).ravel()
    assert successor(controller) == pytest.approx(expected, abs=1e-13)
    after = solver.x.copy()
    controller.prepare()
    assert solver.x[:-1].tolist() == after[1:].tolist()


def test_optimised_chooses_within_its_box_and_else_goes_on(situation):
    tube = tubes(Nominal.OPTIMISED).tractor
    choice, controller = initial_choice(tube), ArticulatedTractor(VEHICLE, PRODUCT, SAMPLE_TIME, tube)
    step(controller, situation(left=0.3))
    follows = placed_successor(controller)
    near = situation(left=follows[1] + 0.5 * choice[0], ahead=0.2, yaw=follows[2], tractor_steering=follows[3])
    plan = step(controller, near)
    assert (np.abs(plan.deviation) <= choice + 1e-9).all()
    assert plan.deviation[0] == pytest.approx(choice[0], abs=1e-6)  # nearer to the path costs less
    follows = placed_successor(controller)
    far = situation(left=follows[1] + 3.0 * choice[0], ahead=0.4, yaw=follows[2], tractor_steering=follows[3])
    plan = step(controller, far)
    assert plan.status is SolverStatus.SOLVED
    assert plan.deviation[0] == pytest.approx(3.0 * choice[0], abs=1e-4)
    assert plan.poses[0, 1] == pytest.approx(follows[1], abs=1e-6)


@pytest.mark.parametrize("nominal", list(Nominal))
def test_plans_turn_and_shift_with_the_world(situation, nominal):
    here, there = (ArticulatedTractor(VEHICLE, PRODUCT, SAMPLE_TIME, tubes(nominal).tractor) for _ in range(2))
    for k in range(4):
        one = situation(left=0.1 + 0.003 * k, ahead=0.2 * k, yaw=0.01, curvature=0.1)
        other = one.turned(2.0, (30.0, -7.0))
        plan, turned = step(here, one), step(there, other)
        assert turned.steering == pytest.approx(plan.steering, abs=1e-9)
        assert turned.deviation == pytest.approx(plan.deviation, abs=1e-9)
        position = (plan.poses[:, :2] @ [1.0, 1.0j]) * complex(math.cos(2.0), math.sin(2.0)) + complex(30.0, -7.0)
        assert turned.poses[:, :2] @ [1.0, 1.0j] == pytest.approx(position, abs=1e-8)
        assert turned.poses[:, 2] == pytest.approx(plan.poses[:, 2] + 2.0, abs=1e-8)


def test_the_trailers_state_is_its_own(situation):
    controller = ArticulatedTrailer(VEHICLE, PRODUCT, SAMPLE_TIME, tubes(Nominal.PROPAGATED).trailer)
    first = situation(hitch=0.05, trailer_steering=0.02)
    step(controller, first, "trailer")
    follows, second = successor(controller), situation(hitch=0.1, trailer_steering=0.0, ahead=0.2)
    plan = step(controller, second, "trailer")
    articulation = second.estimate.tractor.yaw - second.estimate.trailer.yaw
    assert plan.deviation == pytest.approx([articulation - follows[0], -follows[1]], abs=1e-12)
    assert controller.solver.p.shape[1] == 11


@pytest.mark.parametrize("nominal", list(Nominal))
def test_while_the_solver_fails_the_last_plan_is_gone_on_along_and_nothing_held_to_it(situation, nominal):
    controller = ArticulatedTractor(VEHICLE, PRODUCT, SAMPLE_TIME, tubes(nominal).tractor)
    for k in range(3):
        last = step(controller, situation(left=0.1 + 0.02 * k, ahead=0.2 * k, curvature=0.08))
    assert last.status is SolverStatus.SOLVED
    for k in range(1, 4):
        plan = step(controller, situation(left=0.3, ahead=0.4 + 0.2 * k, curvature=0.08).nowhere())
        assert plan.status is not SolverStatus.SOLVED
        assert plan.steering == last.steerings[k]
        assert plan.poses[0].tolist() == last.poses[k].tolist()
        assert plan.deviation.tolist() == [0.0] * 3


def test_after_a_failure_the_nominal_state_is_the_estimate(situation):
    controller = ArticulatedTractor(VEHICLE, PRODUCT, SAMPLE_TIME, tubes(Nominal.PROPAGATED).tractor)
    step(controller, situation(left=0.1))
    bad = situation(left=0.3)
    plan = step(controller, replace(bad, estimate=replace(bad.estimate, speed=math.nan)))
    assert plan.status is not SolverStatus.SOLVED
    assert step(controller, situation(left=0.3, ahead=0.2)).deviation == pytest.approx(np.zeros(3), abs=1e-12)


def test_the_papers_offset_has_no_bound_and_starts_at_the_estimate(situation):
    paper = {"yaw": -3.0, "disturbances": {"tractor_slip": 0.05}}
    tube = tubes(Nominal.OPTIMISED, PAPER, paper, {}).tractor
    controller = TricycleTractor(VEHICLE, PAPER, SAMPLE_TIME, tube)
    assert initial_choice(tube)[0] == math.inf
    step(controller, situation(left=0.3))
    follows = placed_successor(controller)
    plan = step(controller, situation(left=0.4, ahead=0.2, yaw=follows[2]))
    assert plan.deviation[0] == pytest.approx(0.0, abs=1e-9)
