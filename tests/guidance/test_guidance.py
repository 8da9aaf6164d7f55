import math
from dataclasses import replace

import numpy as np
import pytest

from drawbar.errors import PathError
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.guidance import Guidance
from drawbar.guidance.look_ahead import LookAhead
from drawbar.guidance.path import Path
from drawbar.guidance.preview import Preview
from drawbar.guidance.settings import GuidanceSettings
from drawbar.signals import Estimate, Pose, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters

SETTINGS = GuidanceSettings()
EIGHT = figure_eights((8.0,), 20.0)
TRAILER_BEHIND = 2.2


def preview(path: Path = EIGHT, x: float = 0.0) -> Preview:
    start = {"tractor": (x, 0.0), "trailer": (x - TRAILER_BEHIND, 0.0)}
    return Preview(path, SETTINGS, vehicle=VehicleParameters(), stages=15, interval=0.2, **start)


def look_ahead(path: Path = EIGHT) -> LookAhead:
    start = {"tractor": (0.0, 0.0), "trailer": (-TRAILER_BEHIND, 0.0)}
    return LookAhead(path, SETTINGS, stages=15, interval=0.2, speed=1.0, **start)


def beside(path: Path, s: float, left: float, turns: int = 0) -> Pose:
    x, y, yaw, _ = path.sample(np.array([s]))[0].tolist()
    return Pose(x=x - left * math.sin(yaw), y=y + left * math.cos(yaw), yaw=yaw + 2.0 * math.pi * turns)


def estimate(tractor: Pose, trailer: Pose, speed: float = 1.0) -> Estimate:
    return Estimate(
        time=3.0,
        tractor=tractor,
        trailer=trailer,
        hitch_angle=0.0,
        speed=speed,
        tractor_steering=0.0,
        trailer_steering=0.0,
        longitudinal_slip=0.9,
        tractor_slip=1.0,
        trailer_slip=1.0,
        steering_offset=0.0,
        tractor_crab=0.0,
        trailer_crab=0.0,
        status=SolverStatus.SOLVED,
    )


def along(s: float, left: float = 0.0, turns: int = 0) -> Estimate:
    return estimate(beside(EIGHT, s, left, turns), beside(EIGHT, s - TRAILER_BEHIND, -left, turns))


@pytest.mark.parametrize("guidance", [preview(), look_ahead()], ids=["preview", "look-ahead"])
def test_both_bodies_are_followed_through_the_crossing(guidance: Guidance) -> None:
    rng = np.random.default_rng(11)  # seed 11
    for s in np.arange(0.0, EIGHT.length, 0.2):
        assert not guidance.finished
        left = float(rng.uniform(-0.4, 0.4))
        reference = guidance.reference(along(float(s), left))
        assert reference.tractor.progress == pytest.approx(s, abs=1e-6)
        assert reference.trailer.progress == pytest.approx(s - TRAILER_BEHIND, abs=1e-6)
        assert reference.tractor.lateral_error == pytest.approx(left, abs=1e-6)
        assert reference.trailer.lateral_error == pytest.approx(-left, abs=1e-6)
    guidance.reference(along(EIGHT.length + 0.1))
    assert guidance.finished


def test_preview_advances_at_the_speed_over_ground_from_each_bodys_closest_point() -> None:
    guidance = preview()
    for s in np.arange(0.0, 12.0, 0.5):
        reference = guidance.reference(along(float(s)))
    expected = 11.5 + 0.9 * 0.2 * np.arange(16)
    np.testing.assert_allclose(reference.tractor.samples, EIGHT.sample(expected), atol=1e-6)
    np.testing.assert_allclose(reference.trailer.samples, EIGHT.sample(expected - TRAILER_BEHIND), atol=1e-6)
    assert reference.time == 3.0


def test_preview_never_moves_its_reference_back() -> None:
    guidance = preview()
    for s in (0.5, 1.0, 0.7):
        reference = guidance.reference(along(s))
    assert reference.tractor.progress == pytest.approx(0.7)
    assert reference.tractor.samples[0, 0] == pytest.approx(1.0)


def test_look_ahead_is_the_papers() -> None:
    guidance = look_ahead()
    for s in np.arange(0.0, 12.0, 0.5):
        reference = guidance.reference(along(float(s)))
    ahead = 11.5 + 1.6 + 0.2 * np.arange(16)
    np.testing.assert_allclose(reference.tractor.samples, EIGHT.sample(ahead), atol=1e-6)
    constant = EIGHT.sample(np.full(16, 11.5 - TRAILER_BEHIND + 1.6))
    np.testing.assert_allclose(reference.trailer.samples, constant, atol=1e-6)


@pytest.mark.parametrize("turns", [-2, -1, 0, 1])
def test_yaw_is_on_the_branch_of_the_estimate(turns: int) -> None:
    straight, turned = preview().reference(along(1.0)), preview().reference(along(1.0, turns=turns))
    difference = turned.tractor.samples - straight.tractor.samples
    np.testing.assert_allclose(difference[:, 2], 2.0 * math.pi * turns, atol=1e-12)
    np.testing.assert_array_equal(difference[:, [0, 1, 3]], 0.0)


def test_the_search_does_not_reach_beyond_its_window() -> None:
    guidance = preview()
    assert guidance.reference(along(15.0)).tractor.progress <= SETTINGS.window_ahead


def test_a_start_behind_the_path_is_seen_on_its_straight_continuation() -> None:
    reference = preview(x=-2.0).reference(along(-2.0))
    assert reference.tractor.progress == pytest.approx(-2.0)
    assert reference.trailer.progress == pytest.approx(-2.0 - TRAILER_BEHIND)


def test_the_trailer_is_found_further_behind_than_the_tractor_may_be() -> None:
    reference = preview(x=-4.9).reference(along(-4.9))
    assert reference.trailer.progress == pytest.approx(-4.9 - TRAILER_BEHIND)


@pytest.mark.parametrize("position", [(math.nan, 0.0), (0.0, math.inf)])
def test_a_missing_trailer_position_is_refused(position: tuple[float, float]) -> None:
    start = {"tractor": (0.0, 0.0), "trailer": position}
    with pytest.raises(PathError, match=r"the trailer\'s position is missing .*(nan|inf)"):
        LookAhead(EIGHT, SETTINGS, stages=15, interval=0.2, speed=1.0, **start)


def test_a_start_far_from_the_path_is_refused_with_both_positions() -> None:
    with pytest.raises(PathError, match=r"\(-1000\.00, 0\.00\) m is 1000\.00 m .* \(0\.00, 0\.00\).*5 m is allowed"):
        preview(x=-1000.0)
    with pytest.raises(PathError, match=r"the tractor's position is missing \(x = nan m, y = 0\.00 m\)"):
        preview(x=math.nan)


@pytest.mark.parametrize("field", ["x", "y", "yaw"])
def test_a_pose_that_is_not_finite_is_refused_and_leaves_the_progress(field: str) -> None:
    guidance = preview()
    good = beside(EIGHT, 0.5, 0.0)
    bad = Pose(**{"x": good.x, "y": good.y, "yaw": good.yaw} | {field: math.nan})
    for pair in ((bad, good), (good, bad)):
        with pytest.raises(PathError, match="not finite"):
            guidance.reference(estimate(*pair))
    assert guidance.reference(along(0.6)).tractor.progress == pytest.approx(0.6)


def test_a_speed_that_is_not_finite_is_refused() -> None:
    pose = beside(EIGHT, 0.5, 0.0)
    with pytest.raises(PathError, match="speed over ground is nan"):
        preview().reference(estimate(pose, pose, speed=math.nan))


def facing(x: float, yaw: float) -> Estimate:
    return estimate(Pose(x=x, y=0.0, yaw=yaw), Pose(x=x - TRAILER_BEHIND * math.cos(yaw), y=0.0, yaw=yaw))


def test_a_tractor_that_faces_away_is_led_by_turns_and_then_by_the_path_again() -> None:
    guidance = preview()
    pose = facing(0.0, math.pi).tractor
    for _ in range(400):
        samples = guidance.reference(estimate(pose, pose, speed=0.4)).tractor.samples
        assert abs(samples[0, 2] - pose.yaw) < 0.1  # each next pose is the one that was asked for
        pose = Pose(x=samples[1, 0], y=samples[1, 1], yaw=samples[1, 2])
    assert pose.y == pytest.approx(0.0, abs=1e-3)
    assert math.cos(pose.yaw) == pytest.approx(1.0, abs=1e-6)
    expected = EIGHT.sample(pose.x + 0.4 * 0.9 * 0.2 * np.arange(16))
    np.testing.assert_allclose(samples[:, 3], expected[:, 3], atol=1e-3)


def test_turns_that_end_behind_their_beginning_are_followed_by_the_path_from_there() -> None:
    path = figure_eights((8.0,), 200.0)
    guidance = preview(path)
    for x in np.arange(0.0, 60.0, 0.5):
        guidance.reference(facing(float(x), 0.0))
    pose, behind = facing(60.0, math.pi).tractor, math.inf
    for _ in range(250):
        samples = guidance.reference(estimate(pose, pose)).tractor.samples
        assert math.hypot(samples[0, 0] - pose.x, samples[0, 1] - pose.y) < 0.05
        pose = Pose(x=samples[1, 0], y=samples[1, 1], yaw=samples[1, 2])
        behind = min(behind, pose.x)
    assert behind < 59.0


def test_a_second_turn_begins_where_the_tractor_is() -> None:
    guidance = preview()
    pose = facing(0.0, math.pi).tractor
    for _ in range(20):
        samples = guidance.reference(estimate(pose, pose)).tractor.samples
        pose = Pose(x=samples[1, 0], y=samples[1, 1], yaw=samples[1, 2])
    pose = Pose(x=pose.x, y=pose.y, yaw=pose.yaw + 2.0)
    samples = guidance.reference(estimate(pose, pose)).tractor.samples
    assert samples[0, :3] == pytest.approx((pose.x, pose.y, pose.yaw), abs=1e-3)


def test_turns_begin_with_the_curvature_that_the_wheels_have() -> None:
    steered = replace(facing(0.0, math.pi), tractor_steering=0.2, steering_offset=0.02)
    expected = math.tan(0.22) / VehicleParameters().wheelbase
    assert preview().reference(steered).tractor.samples[0, 3] == pytest.approx(expected, abs=0.02)


def test_a_heading_that_turns_out_right_after_all_ends_the_turns() -> None:
    guidance = preview()
    assert np.abs(guidance.reference(facing(0.0, math.pi)).tractor.samples[:, 1]).max() > 0.1
    for x in np.arange(0.2, 12.0, 0.2):
        reference = guidance.reference(along(float(x)))
    expected = EIGHT.sample(11.8 + 0.9 * 0.2 * np.arange(16))
    np.testing.assert_allclose(reference.tractor.samples, expected, atol=1e-2)


@pytest.mark.parametrize("yaw", [-0.9, 0.9])
def test_up_to_sixty_degrees_the_path_itself_is_followed(yaw: float) -> None:
    np.testing.assert_allclose(preview().reference(facing(1.0, yaw)).tractor.samples[:, 1], 0.0, atol=1e-9)


def test_without_room_to_turn_it_says_what_would_help() -> None:
    settings = GuidanceSettings(turning_room=1.0)
    start = {"tractor": (0.0, 0.0), "trailer": (-TRAILER_BEHIND, 0.0)}
    guidance = Preview(EIGHT, settings, vehicle=VehicleParameters(), stages=15, interval=0.2, **start)
    message = r"faces -?180° away .* within 1 m .*turning_room or vehicle.curvature_limit"
    for _ in range(2):
        with pytest.raises(PathError, match=message):
            guidance.reference(facing(0.0, math.pi))
    expected = EIGHT.sample(0.2 + 0.9 * 0.2 * np.arange(16))
    np.testing.assert_allclose(guidance.reference(along(0.2)).tractor.samples, expected, atol=1e-6)
