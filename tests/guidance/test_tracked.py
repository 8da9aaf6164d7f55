"""Tracked points: the bodies' own points are led so that the tracked ones follow the line."""

import math
from itertools import islice

import numpy as np
import pytest
from guides import Preview
from ordinary import believed

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError, PathError
from drawbar.geometry import Floats
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.path import Path
from drawbar.guidance.settings import GuidanceSettings
from drawbar.recording.header import path_notes
from drawbar.report.path_errors import true_path_errors
from drawbar.signals import Pose
from drawbar.simulation import Simulation, build_path
from drawbar.vehicle.off_tracking import steady_off_tracking
from drawbar.vehicle.parameters import TrackedPoint, TrackedPoints, VehicleParameters

EIGHT = figure_eights((10.0,), 20.0)
STEP = 0.1
"""m between samples"""
Arm = tuple[float, float]


def vehicle(tractor: Arm, trailer: Arm) -> VehicleParameters:
    points = [TrackedPoint(forward=forward, left=left) for forward, left in (tractor, trailer)]
    return VehicleParameters(tracked=TrackedPoints(tractor=points[0], trailer=points[1]))


def moved(pose: Pose, forward: float, left: float) -> Pose:
    """Return the pose of a point of a body, from the body's own."""
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    return Pose(x=pose.x + forward * c - left * s, y=pose.y + forward * s + left * c, yaw=pose.yaw)


def led(path: Path, arm: Arm, crab: float = 0.0) -> tuple[Floats, Floats]:
    """Return what a tractor does that is always where guidance wants it next, and how far its tracked point is off.

    (n, 4) m and rad: x, y, yaw of its rear axle and the reference's direction of motion; (n,) m.
    """
    guidance = Preview(
        path,
        GuidanceSettings(),
        vehicle=vehicle(arm, (0.0, arm[1])),
        stages=60,
        interval=STEP,
        tractor=(0.0, -arm[1]),
        trailer=(-2.2, -arm[1]),
    )
    pose, poses, errors = moved(Pose(x=0.0, y=0.0, yaw=-crab), 0.0, -arm[1]), [], []
    for _ in range(600):
        trailer = Pose(x=pose.x - 2.2, y=pose.y, yaw=pose.yaw)
        seen = believed(pose, trailer, time=0.0, speed=1.0, longitudinal_slip=1.0, tractor_crab=crab)
        reference = guidance.reference(seen).tractor
        here = moved(pose, *arm)
        _, error = path.project(here.x, here.y, reference.progress - 1.0, reference.progress + 1.0)
        assert reference.lateral_error == pytest.approx(error, abs=1e-9)
        x, y, yaw, _ = reference.samples[1].tolist()
        poses.append((pose.x, pose.y, pose.yaw, reference.samples[0][2]))
        errors.append(error)
        pose = Pose(x=x, y=y, yaw=yaw - crab)
    return np.array(poses), np.array(errors)


ARMS = [(1.4, 0.0), (-1.5, 0.0), (0.0, 1.2), (-1.0, -1.2), (1.4, 0.8), (1e-6, 0.0)]


@pytest.mark.parametrize("arm", ARMS, ids=str)
def test_a_body_that_follows_leads_its_point_along_the_path_and_rolls_without_slipping(arm: Arm) -> None:
    poses, errors = led(EIGHT, arm)
    assert np.abs(errors[50:]).max() < 0.01
    way = np.diff(poses[50:, :2], axis=0)
    heading = 0.5 * (poses[51:, 2] + poses[50:-1, 2])
    across = np.cos(heading) * way[:, 1] - np.sin(heading) * way[:, 0]
    assert np.abs(across).max() < 0.06 * STEP  # a clothoid's sagitta, and small angles


def test_a_side_slip_is_reckoned_with() -> None:
    _, errors = led(EIGHT, (-1.5, 0.0), crab=0.05)
    assert np.abs(errors[50:140]).max() < 0.01  # without, 7.5 cm


@pytest.mark.parametrize("arm", [(1.4, 0.0), (-1.5, 0.0), (0.0, 1.2), (-1.5, -1.2)])
def test_on_a_circle_the_axle_is_where_geometry_puts_it(arm: Arm) -> None:
    angles = np.arange(0.0, 6.0, 0.02)
    circle = Path.through(
        arc_length=10.0 * angles,
        x=10.0 * np.sin(angles),
        y=10.0 * (1.0 - np.cos(angles)),
        yaw=angles,
        label_of_piece=np.zeros(len(angles) - 1, dtype=np.int8),
        label_names=("arc",),
    )
    poses, _ = led(circle, arm)
    radius = np.hypot(poses[150:420, 0], poses[150:420, 1] - 10.0)
    expected = arm[1] + math.sqrt(100.0 - arm[0] ** 2)
    np.testing.assert_allclose(radius, expected, atol=0.005)


def test_the_bodies_own_points_are_left_as_they_are() -> None:
    plain, tracked = (
        Preview(EIGHT, GuidanceSettings(), vehicle=of, stages=10, interval=0.2, tractor=(0.0, 0.0), trailer=(-2.2, 0.0))
        for of in (VehicleParameters(), vehicle((0.0, 0.0), (0.0, 0.0)))
    )
    for s in (0.0, 2.0, 4.0):
        x, y, yaw, _ = EIGHT.sample(np.array(s)).tolist()
        seen = believed(Pose(x=x, y=y, yaw=yaw), Pose(x=x - 2.0, y=y, yaw=yaw), time=0.0, speed=1.0)
        one, other = plain.reference(seen), tracked.reference(seen)
        np.testing.assert_array_equal(one.tractor.samples, other.tractor.samples)
        np.testing.assert_array_equal(one.trailer.samples, other.trailer.samples)


TOOLS = {
    "the bodies themselves": (),
    "front, 1.4 m ahead of the axle": ("vehicle.tracked.tractor.forward=1.4",),
    "rear linkage, 1 m behind it": ("vehicle.tracked.tractor.forward=-1.0",),
    "1 m behind the trailer's axle": ("vehicle.tracked.trailer.forward=-1.25",),
    "1.2 m to the left": ("vehicle.tracked.tractor.left=1.2", "vehicle.tracked.trailer.left=1.2"),
    "1 m behind it, 1.2 m to the left": (
        "vehicle.tracked.trailer.forward=-1.25",
        "vehicle.tracked.tractor.left=1.2",
        "vehicle.tracked.trailer.left=1.2",
    ),
}
WORLDS = {
    "simulated": (),
    "physics": ("machine.kind=physics",),
    "physics, soft slope of 5°": (
        "machine.kind=physics",
        "machine.terrain.slope=0.0873",
        "machine.terrain.creep=0.36",
        "vehicle.masts.tractor.up=2.5",
        "vehicle.masts.trailer.up=2.0",
        "machine.attitude.tractor.present=true",
        "machine.attitude.trailer.present=true",
    ),
}


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("tool", TOOLS)
def test_a_tool_is_on_the_line_on_straights_and_in_curves(tool: str, world: str) -> None:
    if "physics" in world:
        pytest.importorskip("mujoco")
    changes = ["path.radii=[20.0]", *TOOLS[tool], *WORLDS[world]]
    with Simulation(load_configuration("articulated", changes)) as simulation:
        log = simulation.log()
    assert log.outcome.finished
    errors = true_path_errors(log)
    bodies = [np.abs(body.error[25:]) for body in (errors.tractor, errors.trailer)]
    means, largest = (" / ".join(f"{100.0 * of(body):.1f}" for body in bodies) for of in (np.mean, np.max))
    print(f"\n| {tool} | {world} | {means} ({largest}) |")  # docs/theory/tracked-points.md
    for body in bodies:
        assert body.mean() < 0.035
        assert body.max() < 0.15


def test_a_tool_at_a_crawl_does_not_swing() -> None:
    changes = ["vehicle.tracked.tractor.forward=-2.0", "speed=0.3", "path.straight_length=100.0", "path.radii=[20.0]"]
    with Simulation(load_configuration("articulated", changes)) as simulation:
        errors = [abs(record.reference.tractor.lateral_error) for record in islice(simulation.steps(), 400)]
    assert max(errors[50:]) < 0.1


def test_what_the_trailers_steering_cannot_hold_of_a_tool_is_told_and_shared() -> None:
    far = load_configuration("articulated", ["vehicle.tracked.trailer.forward=-3.25", "path.radii=[10.0]"])
    with Simulation(far) as simulation:
        (note,) = path_notes(far, simulation.path, None)
        errors = true_path_errors(simulation.log())
    assert note.startswith("in curves of 0.1 1/m the trailer runs 0.3")
    on_curves = [errors.tractor.of_class("0.1"), errors.trailer.of_class("0.1")]
    tractor, trailer = (
        np.abs(body.error[there]).mean()
        for body, there in zip((errors.tractor, errors.trailer), on_curves, strict=True)
    )
    assert 0.05 < tractor < trailer < 0.3


@pytest.mark.parametrize("curvature", [0.08, -0.08])
@pytest.mark.parametrize("arms", [((1.0, 0.5), (-3.0, 0.52)), ((-1.5, -1.0), (-2.5, -1.05))])
def test_what_the_steering_leaves_is_what_a_rigid_turn_about_one_centre_leaves(
    curvature: float, arms: tuple[Arm, Arm]
) -> None:
    of, (tractor, trailer), radius = vehicle(*arms), arms, 1.0 / curvature
    left = []
    for joint in np.linspace(-of.trailer_steering_limit, of.trailer_steering_limit, 401):
        # the vehicle about the origin, which the rear axle faces sideways
        axle = Pose(x=0.0, y=-math.copysign(math.sqrt(radius**2 - tractor[0] ** 2), curvature) - tractor[1], yaw=0.0)
        point = moved(axle, *tractor)
        assert math.hypot(point.x, point.y) == pytest.approx(abs(radius))
        joined = moved(axle, -of.free_joint_offset, 0.0)
        far = math.hypot(joined.x, joined.y)
        ahead = of.trailer_length + of.drawbar_length * math.cos(joint)  # of RJ1, on the trailer
        aside = of.drawbar_length * math.sin(joint)
        trailer_axle = math.sqrt(far**2 - ahead**2) * math.copysign(1.0, curvature) + aside  # signed radius
        there = math.hypot(trailer_axle - trailer[1], of.trailer_antenna + trailer[0])
        left.append(abs(there - abs(radius)))
    found = float(steady_off_tracking(of, np.array([curvature]))[0])
    assert found == pytest.approx(min(left), abs=2e-3)


def test_a_tool_beside_the_tractors_is_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"tracked.trailer.left = 1.2 m is 1.2 m beside .* reaches"):
        load_configuration("articulated", ["vehicle.tracked.trailer.left=1.2"])


def test_curves_are_tighter_for_an_axle_inside_of_its_point() -> None:
    reach = ["path.radii=[5.0]", "vehicle.tracked.tractor.left=3.0", "vehicle.tracked.trailer.left=3.0"]
    with pytest.raises(PathError, match="tightest curve"):
        build_path(load_configuration("articulated", reach))


def test_the_papers_guidance_knows_no_other_points() -> None:
    with pytest.raises(ConfigurationError, match=r"vehicle.tracked needs guidance.mode"):
        load_configuration("paper", ["vehicle.tracked.tractor.forward=1.0"])
