import math
from dataclasses import replace

import numpy as np
import pytest
from controllers import first, settled

from drawbar.signals import SolverStatus
from drawbar.vehicle.parameters import BODIES, VehicleParameters

COUPLINGS = ("neglected", "measured", "planned")
OF_EACH_MODEL = [(name, each) for name in ("articulated", "tricycle") for each in COUPLINGS] + [
    ("articulated", "following")
]
VEHICLE = VehicleParameters()


def assert_solved(plan):
    assert (plan.tractor.status, plan.trailer.status) == (SolverStatus.SOLVED,) * 2


def test_no_error_on_a_straight_line_is_no_steering(name, make, situation):
    for yaw in (0.0, 1.0, math.pi, -2.5):
        plan = settled(make(name), situation().turned(yaw, (30.0, -4.0)), steps=3)
        for body in BODIES:
            assert getattr(plan, body).steering == pytest.approx(0.0, abs=1e-9)
            assert getattr(plan, body).steerings == pytest.approx(np.zeros(20), abs=1e-9)


@pytest.mark.parametrize("curvature", [0.1, -0.15])
def test_a_circle_without_error_is_steered_by_its_curvature(make, situation, curvature):
    # docs/theory/control.md: (atan(L k + tan alpha_r) - b) / kappa, in the steady state of slip, crab and offset
    for values in ({}, {"tractor_slip": 0.9, "steering_offset": 0.02, "longitudinal_slip": 0.9}):
        kappa, offset = values.get("tractor_slip", 1.0), values.get("steering_offset", 0.0)
        steady = (math.atan(1.4 * curvature) - offset) / kappa
        controller = make("articulated")
        for step in range(30):
            pace = 0.2 * values.get("longitudinal_slip", 1.0)
            plan = first(
                controller, situation(curvature=curvature, ahead=step * pace, tractor_steering=steady, **values)
            )
            controller.prepare()
        assert plan.tractor.steering == pytest.approx(steady, abs=1e-5)
        assert plan.tractor.steerings == pytest.approx(np.full(20, steady), abs=1e-5)


@pytest.mark.parametrize(("name", "coupling"), OF_EACH_MODEL)
def test_plans_are_mirrored_with_the_world(name, make, random_situations, coupling):
    for one in random_situations:
        plan, mirrored = first(make(name, coupling), one), first(make(name, coupling), one.mirrored())
        for body in BODIES:
            here, there = getattr(plan, body), getattr(mirrored, body)
            assert there.status == here.status
            assert there.steering == pytest.approx(-here.steering, abs=1e-9)
            assert there.steerings == pytest.approx(-here.steerings, abs=1e-9)
            assert there.poses == pytest.approx(here.poses * [1.0, -1.0, -1.0], abs=1e-9)


@pytest.mark.parametrize(("name", "coupling"), OF_EACH_MODEL)
def test_plans_turn_and_shift_with_the_world(name, make, random_situations, coupling):
    for one in random_situations:
        plan = first(make(name, coupling), one)
        assert_solved(plan)
        for angle in (1.0, math.pi, -2.0, 7.0):
            turned = first(make(name, coupling), one.turned(angle, (40.0, -90.0)))
            for body in BODIES:
                here, there = getattr(plan, body), getattr(turned, body)
                assert there.steering == pytest.approx(here.steering, abs=1e-9)
                assert there.steerings == pytest.approx(here.steerings, abs=1e-9)
                assert there.poses[:, 2] == pytest.approx(here.poses[:, 2] + angle, abs=1e-9)


def test_an_offset_is_steered_away(make, situation):
    for name in ("articulated", "tricycle"):
        plan = settled(make(name), situation(left=0.1))
        assert plan.tractor.steering < -1e-3
        assert abs(plan.tractor.poses[-1, 1]) < 0.1


def test_no_plan_exceeds_the_limits(name, make, situation, random_situations):
    for one in [*random_situations, situation(left=3.0), situation(left=-3.0, yaw=-0.8), situation(hitch=0.9)]:
        plan = settled(make(name), one, steps=5)
        assert abs(plan.tractor.steering) <= math.radians(30.0) + 1e-9
        assert abs(plan.trailer.steering) <= math.radians(20.0) + 1e-9


def test_the_first_pose_of_a_plan_is_the_estimate(name, make, random_situations):
    for one in random_situations:
        plan = first(make(name), one)
        for body in BODIES:
            pose = getattr(one.estimate, body)
            assert getattr(plan, body).poses[0] == pytest.approx([pose.x, pose.y, pose.yaw], abs=1e-9)


def test_neglected_coupling_does_not_see_the_tractors_steering(name, make, situation):
    straight, curved = (situation(left=0.01, tractor_steering=angle) for angle in (0.0, 0.1))
    plans = [first(make(name, "neglected"), one).trailer.steering for one in (straight, curved)]
    assert plans[0] == pytest.approx(plans[1], abs=1e-12)
    seen = [first(make(name, "measured"), one).trailer.steering for one in (straight, curved)]
    assert abs(seen[0] - seen[1]) > 1e-3
    assert seen[0] == pytest.approx(plans[0], abs=1e-9)


def test_the_tractors_steering_rate_weighs_less_the_faster_it_is(make, situation):
    controller = make("articulated")
    weight = controller.tractor.solver.w[:-1, 3]
    calm = weight[0]
    for speed, share in ((0.5, 1.0), (1.05, 1.0), (2.0, 0.5), (2.1, 0.5), (3.0, 1.0 / 3.0), (0.5, 1.0)):
        first(controller, situation(speed=speed))
        assert weight == pytest.approx(np.full(20, share * calm), rel=1e-12)


def test_planned_coupling_sees_what_the_tractor_will_do(make, name, situation):
    # the tractor is still straight but will have to turn: only its plan shows that
    about_to_turn = situation(curvature=0.02, tractor_steering=0.0)
    plans = {coupling: settled(make(name, coupling), about_to_turn).trailer.steerings for coupling in COUPLINGS}
    assert plans["measured"] == pytest.approx(plans["neglected"], abs=1e-9)
    assert np.abs(plans["planned"] - plans["measured"]).max() > 1e-3


def drawbar_lengths(plan):
    """Return the distance between both ends of the drawbar along the plans of tractor and trailer (N+1,), m."""
    tractor, trailer = plan.tractor.poses, plan.trailer.poses
    a, back = VEHICLE.free_joint_offset, VEHICLE.trailer_length - VEHICLE.trailer_antenna
    front = tractor[:, :2] - a * np.stack([np.cos(tractor[:, 2]), np.sin(tractor[:, 2])], axis=1)
    rear = trailer[:, :2] + back * np.stack([np.cos(trailer[:, 2]), np.sin(trailer[:, 2])], axis=1)
    return np.linalg.norm(front - rear, axis=1)


def test_with_planned_coupling_the_planned_trailer_hangs_on_the_planned_tractor(make, situation):
    one = situation(curvature=0.15, left=0.1, tractor_steering=0.1)
    planned = drawbar_lengths(settled(make("articulated", "planned"), one))
    assert planned == pytest.approx(np.full(21, VEHICLE.drawbar_length), abs=1e-12)
    measured = drawbar_lengths(settled(make("articulated", "measured"), one))
    assert measured[0] == pytest.approx(VEHICLE.drawbar_length, abs=1e-12)
    assert abs(measured[-1] - VEHICLE.drawbar_length) > 0.01


def test_with_measured_coupling_the_tractor_goes_on_round_its_present_circle(make, situation):
    controller, crab = make("articulated", "measured"), 0.05
    one = situation(tractor_steering=0.2, tractor_crab=crab, yaw=0.3, longitudinal_slip=0.9)
    settled(controller, one, steps=150)  # the yaw rate's filter too
    first(controller, one)
    known, pose = controller.trailer.solver.p, one.estimate.tractor
    omega = 0.9 * (math.tan(0.2) - math.tan(crab)) / VEHICLE.wheelbase
    time = 0.2 * np.arange(21)
    course = pose.yaw + crab + omega * time
    radius = 0.9 / math.cos(crab) / omega
    assert known[:, 4] == pytest.approx(np.full(21, omega), abs=1e-9)
    assert known[:, 5] == pytest.approx(pose.x + radius * (np.sin(course) - math.sin(course[0])), abs=1e-8)
    assert known[:, 6] == pytest.approx(pose.y - radius * (np.cos(course) - math.cos(course[0])), abs=1e-8)
    assert known[:, 7] == pytest.approx(pose.yaw + omega * time, abs=1e-8)


@pytest.mark.parametrize(("left", "yaw", "curvature"), [(0.0, 0.0, 0.1), (0.3, -0.1, 0.0), (-0.2, 0.15, -0.08)])
def test_with_following_coupling_the_tractor_comes_back_to_its_line(make, situation, left, yaw, curvature):
    controller, crab = make("articulated", "following"), 0.03
    one = situation(left=left, yaw=yaw, curvature=curvature, tractor_crab=crab, longitudinal_slip=0.9)
    first(controller, one)
    known, line, pose = controller.trailer.solver.p, one.reference.tractor.samples, one.estimate.tractor
    x, y, heading = known[:, 5], known[:, 6], known[:, 7]
    assert [x[0], y[0], heading[0]] == pytest.approx([pose.x, pose.y, pose.yaw], abs=1e-12)
    beside = np.cos(line[:, 2]) * (y - line[:, 1]) - np.sin(line[:, 2]) * (x - line[:, 0])
    along, length = 0.9 * 0.2 * np.arange(21), 0.9
    slope = math.tan(pose.yaw + crab - line[0, 2])
    critical = (beside[0] + (slope + beside[0] / length) * along) * np.exp(-along / length)
    assert beside == pytest.approx(critical, abs=1e-12)
    assert heading + crab - line[:, 2] == pytest.approx(np.arctan(np.gradient(critical, along)), abs=0.02)
    assert known[:-1, 4] == pytest.approx(np.diff(heading) / 0.2, abs=1e-9)


def test_where_nothing_is_to_be_done_the_solver_says_solved(name, make, situation):
    for yaw in (0.0, 1.0, math.pi, -2.5):
        assert_solved(settled(make(name), situation().turned(yaw, (30.0, -4.0)), steps=3))


@pytest.mark.parametrize(
    "part",
    ["speed", "longitudinal_slip", "tractor_slip", "tractor_crab", "trailer_crab", "tractor_steering", "tractor"],
)
def test_an_estimate_that_is_not_finite_harms_no_later_plan(name, make, situation, part):
    one = situation(left=0.02, curvature=0.1)
    controller, other = make(name), make(name)
    bad = replace(one.estimate.tractor, yaw=math.nan) if part == "tractor" else math.nan
    for each in (controller, other):
        settled(each, one, steps=5)
    first(controller, replace(one, estimate=replace(one.estimate, **{part: bad})))
    controller.prepare()
    here, there = (settled(each, one) for each in (controller, other))
    assert_solved(here)
    for body in BODIES:
        assert getattr(here, body).steerings == pytest.approx(getattr(there, body).steerings, abs=1e-8)
