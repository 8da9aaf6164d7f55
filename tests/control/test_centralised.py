"""The centralised controllers: one problem for both bodies, judged by independent solvers, limits and symmetry."""

import math
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from controllers import (
    ArticulatedTractor,
    CentralisedArticulated,
    CentralisedTricycle,
    DecentralisedController,
    TricycleTractor,
    TricycleTrailer,
    first,
    settled,
)
from scipy.optimize import least_squares

from drawbar.control.settings import (
    ArticulatedControllerSettings,
    ArticulatedTrailerWeights,
    BodyTubeSettings,
    Coupling,
    Nominal,
    SharingSettings,
    TricycleControllerSettings,
    TubeSettings,
)
from drawbar.control.tube.tube import tubes_of
from drawbar.errors import ConfigurationError
from drawbar.optimal import ControlSolver
from drawbar.signals import SolverStatus
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.parameters import BODIES, VehicleParameters
from drawbar.vehicle.tricycle import tricycle

VEHICLE, DT, HORIZON = VehicleParameters(), 0.2, 20
NO_TUBE = TubeSettings()
PAPER = TricycleControllerSettings(model="tricycle", horizon=HORIZON)
PRODUCT = ArticulatedControllerSettings(
    model="articulated", horizon=HORIZON, trailer=ArticulatedTrailerWeights(steering_rate=1.0)
)
"""calm enough that no bound is in the way"""


def tubes(settings, declared=NO_TUBE):
    return tubes_of(VEHICLE, settings, declared, speed=1.0, sample_time=DT)


def centralised(name, vehicle=VEHICLE, declared=NO_TUBE):
    if name == "tricycle":
        return CentralisedTricycle(vehicle, PAPER, DT, tubes(PAPER, declared))
    return CentralisedArticulated(vehicle, PRODUCT, DT, tubes(PRODUCT, declared))


def tractors_part(situation):
    """Return what the tractor's own controller sees of a situation."""
    return SimpleNamespace(estimate=situation.estimate, reference=situation.reference.tractor)


def assert_same(one, other, tolerance):
    assert one.status is other.status is SolverStatus.SOLVED
    assert one.steering == pytest.approx(other.steering, abs=tolerance)
    assert one.steerings == pytest.approx(other.steerings, abs=tolerance)
    assert one.poses == pytest.approx(other.poses, abs=tolerance)


def test_no_error_on_a_straight_line_is_no_steering(name, situation):
    for yaw in (0.0, 1.0, math.pi, -2.5):
        plan = settled(centralised(name), situation().turned(yaw, (30.0, -4.0)), steps=3)
        for body in BODIES:
            assert getattr(plan, body).status is SolverStatus.SOLVED
            assert getattr(plan, body).steering == pytest.approx(0.0, abs=1e-9)
            assert getattr(plan, body).steerings == pytest.approx(np.zeros(HORIZON), abs=1e-9)


def test_plans_are_mirrored_with_the_world(name, random_situations):
    for one in random_situations:
        plan, mirrored = first(centralised(name), one), first(centralised(name), one.mirrored())
        for body in BODIES:
            here, there = getattr(plan, body), getattr(mirrored, body)
            assert there.status is here.status is SolverStatus.SOLVED
            assert there.steering == pytest.approx(-here.steering, abs=1e-9)
            assert there.steerings == pytest.approx(-here.steerings, abs=1e-9)
            assert there.poses == pytest.approx(here.poses * [1.0, -1.0, -1.0], abs=1e-9)


def test_plans_turn_and_shift_with_the_world(name, random_situations):
    for one in random_situations:
        plan = first(centralised(name), one)
        for angle in (1.0, math.pi, -2.0, 7.0):
            turned = first(centralised(name), one.turned(angle, (40.0, -90.0)))
            for body in BODIES:
                here, there = getattr(plan, body), getattr(turned, body)
                assert there.steering == pytest.approx(here.steering, abs=1e-9)
                assert there.steerings == pytest.approx(here.steerings, abs=1e-9)
                assert there.poses[:, 2] == pytest.approx(here.poses[:, 2] + angle, abs=1e-9)


def test_the_first_pose_of_a_plan_is_the_estimate(name, random_situations):
    for one in random_situations:
        plan = first(centralised(name), one)
        for body in BODIES:
            pose = getattr(one.estimate, body)
            assert getattr(plan, body).poses[0] == pytest.approx([pose.x, pose.y, pose.yaw], abs=1e-9)


def test_no_plan_exceeds_the_limits(name, situation, random_situations):
    for one in [*random_situations, situation(left=3.0), situation(left=-3.0, yaw=-0.8), situation(hitch=0.9)]:
        plan = settled(centralised(name), one, steps=5)
        assert abs(plan.tractor.steering) <= math.radians(30.0) + 1e-9
        assert abs(plan.trailer.steering) <= math.radians(20.0) + 1e-9


def test_one_failure_is_both_bodies_and_the_next_plan_starts_afresh(name, situation):
    controller, one = centralised(name), situation(left=0.1)
    expected = settled(centralised(name), one)
    settled(controller, one, steps=2)
    broken = first(controller, situation(left=math.nan))
    assert broken.tractor.status is broken.trailer.status is SolverStatus.BAD_INPUT
    controller.prepare()
    recovered = settled(controller, one)
    for body in BODIES:
        assert_same(getattr(recovered, body), getattr(expected, body), 1e-8)


def test_a_torn_plan_is_called_so_and_given_up(name, situation):
    controller, one = centralised(name), situation()
    first(controller, one)
    controller.solver.x[10:, 0] += 3.0
    controller.prepare()
    torn = first(controller, one)
    assert torn.tractor.status is torn.trailer.status is SolverStatus.CHECK_FAILED
    controller.prepare()
    assert first(controller, one).tractor.status is SolverStatus.SOLVED


def rolled_out(model, initial, p):
    """Return a function of inputs u (N nu,) that gives the states (N+1, nx), by single shooting."""
    step = ca.Function("F", [model.x, model.u, model.p], [integrate(model, DT)]).mapaccum(HORIZON)
    known = np.tile(p, (HORIZON, 1)).T

    def states(u):
        later = np.array(step(initial, u.reshape(HORIZON, 2).T, known)).T
        return np.vstack([initial, later])

    return states


def beside(positions, samples):
    """Return the distances (n,) left of the reference's tangents, m."""
    away = positions - samples[:, :2]
    return np.cos(samples[:, 2]) * away[:, 1] - np.sin(samples[:, 2]) * away[:, 0]


def antenna(x):
    """Return the trailer antenna's positions (n, 2) from states of the chain."""
    back = VEHICLE.trailer_length - VEHICLE.trailer_antenna
    lengths = (VEHICLE.free_joint_offset, x[:, 2]), (VEHICLE.drawbar_length, x[:, 3] + x[:, 5]), (back, x[:, 3])
    return x[:, :2] - sum(length * np.stack([np.cos(a), np.sin(a)], axis=1) for length, a in lengths)


def paper_residuals(one):
    """Return the paper's sum of squares as a function of u: Q = diag(1, 1, 0), R = 10, S = diag(10, 10, 0), twice."""
    e, front, rear = one.estimate, one.reference.tractor.samples, one.reference.trailer.samples
    initial = np.array([e.tractor.x, e.tractor.y, e.tractor.yaw, e.trailer.x, e.trailer.y, e.trailer.yaw])
    p = [e.longitudinal_slip, e.tractor_slip, e.trailer_slip, e.hitch_angle, e.speed]
    states = rolled_out(tricycle(VEHICLE), initial, p)
    q = np.append(np.ones(HORIZON), math.sqrt(10.0))[:, None]

    def residuals(u):
        x = states(u)
        inputs = math.sqrt(10.0) * (u.reshape(HORIZON, 2) - [e.tractor_steering, e.trailer_steering])
        errors = q * (x[:, :2] - front[:, :2]), q * (x[:, 3:5] - rear[:, :2])
        return np.concatenate([*(error.ravel() for error in errors), inputs.ravel()])

    return residuals


def product_residuals(one):
    """Return the product's sum of squares as a function of u: both bodies' costs around the feed-forward."""
    e, front, rear = one.estimate, one.reference.tractor.samples, one.reference.trailer.samples
    poses = e.tractor.x, e.tractor.y, e.tractor.yaw, e.trailer.yaw
    p = [e.longitudinal_slip, e.tractor_slip, e.steering_offset, e.trailer_crab, e.speed, e.tractor_crab]
    states = rolled_out(articulated(VEHICLE), np.array([*poses, e.tractor_steering, e.trailer_steering]), p)
    turn = np.arctan(VEHICLE.wheelbase * front[:, 3] + math.tan(e.tractor_crab))
    forward = (turn - e.steering_offset) / e.tractor_slip
    a, b = PRODUCT.tractor, PRODUCT.trailer
    pace = e.speed if e.speed > 1.1 else 1.0  # rate_weight.h: a change below a tenth is none

    def residuals(u):
        x, rates = states(u), u.reshape(HORIZON, 2)
        terms = (
            (a.lateral, beside(x[:, :2], front)),
            (a.heading, x[:, 2] + e.tractor_crab - front[:, 2]),
            (a.steering, x[:, 4] - forward),
            (a.steering_rate / pace, rates[:, 0]),
            (b.lateral, beside(antenna(x), rear)),
            (b.steering, x[:, 5]),
            (b.steering_rate, rates[:, 1]),
        )
        return np.concatenate([math.sqrt(weight) * term for weight, term in terms])

    return residuals


def rested(solver):
    """Return a solver of the same problem with the same data, where it ends: not the next sample's, as settled does."""
    apart = ControlSolver(solver.problem)
    for name in ("x", "u", "p", "y", "w", "initial"):
        apart.workspace.array(name)[:] = solver.workspace.array(name)
    for _ in range(15):
        apart.prepare()
        assert apart.feedback() == SolverStatus.SOLVED
    return apart


def test_the_settled_plan_is_the_least_sum_of_squares(name, random_situations):
    for one in random_situations[:3]:
        controller = centralised(name)
        first(controller, one)
        u = rested(controller.solver).u
        residuals = paper_residuals(one) if name == "tricycle" else product_residuals(one)
        best = least_squares(residuals, np.zeros(2 * HORIZON), xtol=1e-14, ftol=1e-14, gtol=1e-14)
        assert np.abs(best.x).max() > 1e-3
        assert u.ravel() == pytest.approx(best.x, abs=1e-6)


def test_without_a_lever_the_papers_problem_falls_apart_into_the_decentralised_two(random_situations):
    # l = 0: the tractor's steering does not pull the trailer, so nothing joins the two
    vehicle = VEHICLE.model_copy(update={"hitch_length": 1e-12})
    for coupling in Coupling:
        settings = PAPER.model_copy(update={"coupling": coupling})
        pair = DecentralisedController(
            TricycleTractor(vehicle, settings, DT, tubes(settings).tractor),
            TricycleTrailer(vehicle, settings, DT, tubes(settings).trailer),
        )
        for one in random_situations[:3]:
            apart, joined = settled(pair, one), settled(centralised("tricycle", vehicle), one)
            for body in BODIES:
                assert_same(getattr(joined, body), getattr(apart, body), 1e-7)


def test_with_its_lever_the_papers_trailer_pulls_at_the_tractors_plan(random_situations):
    for one in random_situations[:3]:
        alone = settled(TricycleTractor(VEHICLE, PAPER, DT, tubes(PAPER).tractor), tractors_part(one))
        joined = settled(centralised("tricycle"), one).tractor
        assert np.abs(joined.steerings - alone.steerings).max() > 1e-3


def test_a_trailer_that_does_not_count_leaves_the_tractor_its_own_plan(random_situations):
    weightless = ArticulatedTrailerWeights(lateral=1e-9, steering=0.0, steering_rate=1.0)
    settings = PRODUCT.model_copy(update={"trailer": weightless, "sharing": SharingSettings(share=0.0, widening=0.0)})
    for one in random_situations[:3]:
        alone = settled(ArticulatedTractor(VEHICLE, settings, DT, tubes(settings).tractor), tractors_part(one))
        joined = settled(CentralisedArticulated(VEHICLE, settings, DT, tubes(settings)), one)
        assert_same(joined.tractor, alone, 1e-6)


def test_the_planned_trailer_hangs_on_the_planned_tractor(situation):
    plan = settled(centralised("articulated"), situation(curvature=0.15, left=0.1, tractor_steering=0.1))
    tractor, trailer = plan.tractor.poses, plan.trailer.poses
    a, back = VEHICLE.free_joint_offset, VEHICLE.trailer_length - VEHICLE.trailer_antenna
    front = tractor[:, :2] - a * np.stack([np.cos(tractor[:, 2]), np.sin(tractor[:, 2])], axis=1)
    rear = trailer[:, :2] + back * np.stack([np.cos(trailer[:, 2]), np.sin(trailer[:, 2])], axis=1)
    lengths = np.linalg.norm(front - rear, axis=1)
    assert lengths == pytest.approx(np.full(HORIZON + 1, VEHICLE.drawbar_length), abs=1e-12)


def test_a_trailer_that_cuts_in_moves_the_tractor_outwards(situation):
    # the joint cannot make up for the curve; only one cost for both can share what remains
    one = situation(curvature=0.15, tractor_steering=math.atan(0.21), hitch=0.36)
    settings = PRODUCT.model_copy(update={"sharing": SharingSettings(share=0.0, widening=0.0)})
    apart = settled(ArticulatedTractor(VEHICLE, settings, DT, tubes(settings).tractor), tractors_part(one))
    joined = settled(centralised("articulated"), one)
    samples = one.reference.tractor.samples
    assert beside(joined.tractor.poses[:, :2], samples).min() < beside(apart.poses[:, :2], samples).min() - 0.01


def second(controller, before, after):
    """Return the plan of the sample after the one that predicted."""
    first(controller, before)
    controller.prepare()
    return first(controller, after)


def test_the_deviations_are_those_of_the_decentralised_laws(name, make, situation):
    # straight ahead both structures foretell the same, so that whatever is then off is off by the same
    before, after = situation(), situation(ahead=0.2, left=0.03, yaw=0.02, hitch=0.01, trailer_steering=0.015)
    here, there = (second(controller, before, after) for controller in (centralised(name), make(name)))
    for body in BODIES:
        assert getattr(here, body).deviation == pytest.approx(getattr(there, body).deviation, abs=1e-9)
        assert np.abs(getattr(here, body).deviation).max() > 0.01


def test_a_command_at_its_limit_is_what_the_prediction_reckons_with(situation):
    # the trailer far to the left: the joint is to turn at full rate, which the lag allows only short of the limit
    limit, steering = VEHICLE.trailer_steering_limit, 0.3
    controller, before = centralised("articulated"), situation(left=1.0, trailer_steering=steering)
    plan = first(controller, before)
    assert plan.trailer.steering == limit
    controller.prepare()
    reached = limit - (limit - steering) * math.exp(-DT / VEHICLE.steering_lag)
    after = first(controller, situation(ahead=0.2, left=1.0, trailer_steering=reached))
    assert after.trailer.deviation[1] == pytest.approx(0.0, abs=1e-9)


def test_a_first_plan_has_no_prediction_to_hold(name, random_situations):
    plan = first(centralised(name), random_situations[0])
    for body in BODIES:  # the trailer of this situation is not quite where its closest point says
        deviation = getattr(plan, body).deviation
        assert deviation == pytest.approx(np.zeros(deviation.size), abs=1e-5)


def test_after_a_failure_there_is_none_either(name, situation):
    controller = centralised(name)
    settled(controller, situation(), steps=1)
    settled(controller, situation(ahead=math.nan), steps=1)
    plan = first(controller, situation(left=0.1))
    for body in BODIES:
        deviation = getattr(plan, body).deviation
        assert deviation == pytest.approx(np.zeros(deviation.size), abs=1e-5)


def test_how_far_along_the_path_the_vehicle_got_is_no_deviation(name, situation):
    before = situation(curvature=0.1)
    near, far = (second(centralised(name), before, situation(curvature=0.1, ahead=ahead)) for ahead in (0.2, 0.5))
    for body in BODIES:
        assert getattr(near, body).deviation == pytest.approx(getattr(far, body).deviation, abs=1e-9)
        assert 1e-6 < np.abs(getattr(near, body).deviation).max() < 0.1


def test_the_tubes_tighten_its_bounds(name, situation):
    declared = TubeSettings(tractor=BodyTubeSettings(yaw=-1.0, estimation={"yaw": 0.03}))
    bounds = tubes(PAPER if name == "tricycle" else PRODUCT, declared).tractor.bounds
    left = bounds["command" if name == "tricycle" else "steering"].tightened
    assert 0.0 < left < VEHICLE.tractor_steering_limit - 0.01
    for side in (12.0, -12.0):
        plan = first(centralised(name, declared=declared), situation(left=side))
        assert np.abs(plan.tractor.steerings).max() == pytest.approx(left, abs=1e-9)


@pytest.mark.parametrize("nominal", [Nominal.PROPAGATED, Nominal.OPTIMISED])
def test_a_nominal_state_of_its_own_is_refused(name, nominal):
    with pytest.raises(ConfigurationError, match='only "predicted" is possible'):
        centralised(name, declared=TubeSettings(nominal=nominal))


@pytest.mark.parametrize("name", ["articulated", "paper"])
def test_a_run_reaches_the_end_of_its_path(simulate, name):
    run = simulate(f"{name}-centralised", "path.radii=[8.0]")
    assert run.column("reference", "tractor", "progress")[-1] > run.path.length - 3.0
    assert run.column("solver_failures").sum() == 0
    largest = {"articulated": 0.1, "paper": 1.6}[name]
    for body in BODIES:
        assert np.abs(run.true_errors(body).error).max() < largest
