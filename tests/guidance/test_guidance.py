import math
from dataclasses import replace

import numpy as np
import pytest
from guides import Guidance, LookAhead, Preview
from ordinary import believed

from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.path import Path
from drawbar.guidance.settings import GuidanceSettings
from drawbar.signals import Estimate, GuidanceStatus, Pose
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
    return believed(tractor, trailer, time=3.0, speed=speed, longitudinal_slip=0.9)


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
    guidance = LookAhead(EIGHT, SETTINGS, stages=15, interval=0.2, speed=1.0, **start)
    assert guidance.begun is GuidanceStatus.POSE_NOT_FINITE


@pytest.mark.parametrize(
    ("x", "begun"),
    [
        (-4.99, GuidanceStatus.FINE),
        (-5.01, GuidanceStatus.FAR_FROM_START),
        (5.01, GuidanceStatus.FAR_FROM_START),
        (math.nan, GuidanceStatus.FAR_FROM_START),
    ],
)
def test_a_start_far_from_the_path_is_refused(x: float, begun: GuidanceStatus) -> None:
    assert preview(x=x).begun is begun


@pytest.mark.parametrize("field", ["x", "y", "yaw"])
def test_a_pose_that_is_not_finite_is_refused_and_leaves_the_progress(field: str) -> None:
    guidance = preview()
    good = beside(EIGHT, 0.5, 0.0)
    bad = Pose(**{"x": good.x, "y": good.y, "yaw": good.yaw} | {field: math.nan})
    for pair in ((bad, good), (good, bad)):
        assert guidance.advance(estimate(*pair)) is GuidanceStatus.POSE_NOT_FINITE
    assert guidance.reference(along(0.6)).tractor.progress == pytest.approx(0.6)


def test_a_speed_that_is_not_finite_is_refused() -> None:
    pose = beside(EIGHT, 0.5, 0.0)
    assert preview().advance(estimate(pose, pose, speed=math.nan)) is GuidanceStatus.SPEED_NOT_FINITE


def begun_at(kind: type[Guidance], s: float, left: float = 0.0, *, start: float) -> Guidance:
    """Return guidance that begins at an arc length of the path with a vehicle that stands beside another."""
    places = [beside(EIGHT, at, left) for at in (s, s - TRAILER_BEHIND)]
    where = dict(zip(("tractor", "trailer"), [(pose.x, pose.y) for pose in places], strict=True))
    own = {"vehicle": VehicleParameters()} if kind is Preview else {"speed": 1.0}
    return kind(EIGHT, SETTINGS, stages=15, interval=0.2, start=start, **own, **where)


KINDS = pytest.mark.parametrize("kind", [Preview, LookAhead])


@KINDS
@pytest.mark.parametrize("start", [0.5, 15.0, 31.4, EIGHT.length - 5.0])
@pytest.mark.parametrize("away", [-4.5, 0.0, 4.5])
def test_a_run_may_begin_anywhere_on_the_path(kind: type[Guidance], start: float, away: float) -> None:
    guidance = begun_at(kind, start + away, 0.3, start=start)
    assert guidance.begun is GuidanceStatus.FINE
    assert not guidance.finished
    for s in start + away + np.arange(0.0, 4.0, 0.2):
        reference = guidance.reference(along(float(s), 0.3))
        assert reference.tractor.progress == pytest.approx(s, abs=1e-6)
        assert reference.trailer.progress == pytest.approx(s - TRAILER_BEHIND, abs=1e-6)
        assert reference.tractor.lateral_error == pytest.approx(0.3, abs=1e-6)


@KINDS
@pytest.mark.parametrize("s", [0.0, EIGHT.length / 2.0, EIGHT.length - 0.1])
def test_where_the_path_crosses_itself_a_run_begins_on_the_branch_that_was_said(kind: type[Guidance], s: float) -> None:
    assert math.hypot(*EIGHT.sample(np.array([s]))[0, :2]) < 0.11
    reference = begun_at(kind, s, start=s).reference(along(s))
    assert reference.tractor.progress == pytest.approx(s, abs=1e-6)
    assert reference.trailer.progress == pytest.approx(s - TRAILER_BEHIND, abs=1e-6)


@KINDS
def test_too_far_from_where_it_is_to_begin_no_run_begins(kind: type[Guidance]) -> None:
    start = 31.4
    assert begun_at(kind, start + 5.5, start=start).begun is GuidanceStatus.FAR_FROM_START
    assert begun_at(kind, 0.0, start=start).begun is GuidanceStatus.FAR_FROM_START
    assert begun_at(kind, start, 5.1, start=start).begun is GuidanceStatus.FAR_FROM_START


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
def test_up_to_sixty_degrees_no_turns_are_made(yaw: float) -> None:
    np.testing.assert_allclose(preview().reference(facing(1.0, yaw)).tractor.samples[:, 1], 0.0, atol=1e-9)


def test_without_room_to_turn_there_is_no_way_until_the_tractor_faces_ahead() -> None:
    settings = GuidanceSettings(turning_room=1.0)
    start = {"tractor": (0.0, 0.0), "trailer": (-TRAILER_BEHIND, 0.0)}
    guidance = Preview(EIGHT, settings, vehicle=VehicleParameters(), stages=15, interval=0.2, **start)
    for _ in range(2):
        assert guidance.advance(facing(0.0, math.pi)) is GuidanceStatus.NO_WAY
    expected = EIGHT.sample(0.2 + 0.9 * 0.2 * np.arange(16))
    np.testing.assert_allclose(guidance.reference(along(0.2)).tractor.samples, expected, atol=1e-6)


def join_of(speed: float, left: float, behind: float) -> tuple[np.ndarray, np.ndarray]:
    """Return how far beside a straight line both bodies are led that begin so far to its left: place and offset, m."""
    guidance, along_straight, offsets = preview(figure_eights((8.0,), 200.0)), [], []
    for x in np.arange(0.0, 25.0, 0.02):
        tractor, trailer = Pose(x=float(x), y=left, yaw=0.0), Pose(x=float(x) - TRAILER_BEHIND, y=behind, yaw=0.0)
        reference = guidance.reference(estimate(tractor, trailer, speed=speed))
        assert (reference.tractor.lateral_error, reference.trailer.lateral_error) == pytest.approx((left, behind))
        along_straight.append(reference.tractor.samples[0, 0])
        offsets.append((reference.tractor.samples[0, 1], reference.trailer.samples[0, 1]))
    return np.array(along_straight), np.array(offsets)


@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_a_vehicle_that_begins_beside_the_line_is_led_onto_it_with_little_jerk(speed: float) -> None:
    x, offsets = join_of(speed, 0.4, -0.3)
    assert offsets[0] == pytest.approx((0.4, -0.3), abs=1e-9)  # each body from where it is
    assert np.all(offsets[-1] == 0.0)
    over_ground = 0.9 * speed  # the longitudinal slip of the estimates is 0.9
    jerk = np.diff(offsets, 3, axis=0) * (over_ground / (x[1] - x[0])) ** 3
    assert np.abs(jerk).max() == pytest.approx(0.2, rel=0.1)
    done = x[np.argmax(np.all(offsets == 0.0, axis=1))] - x[0]
    assert done == pytest.approx(over_ground * (60.0 * 0.4 / 0.2) ** (1 / 3), abs=0.2)


def test_the_stages_of_a_join_continue_at_the_speed_over_ground_also_in_a_curve() -> None:
    guidance = under_way(Preview, 26.0)  # in the first curve, of 8 m radius
    guidance.rejoin()
    samples = guidance.reference(along(26.0, left=1.0)).tractor.samples
    between = np.hypot(*np.diff(samples[:, :2], axis=0).T)
    assert between == pytest.approx(np.full(15, 0.9 * 0.2), rel=0.03)


def test_from_far_beside_the_line_there_is_no_join() -> None:
    far = 0.6 / VehicleParameters().curvature_limit
    np.testing.assert_allclose(preview().reference(along(1.0, left=far)).tractor.samples[:, 1], 0.0, atol=1e-9)


def test_a_join_begins_again_only_where_it_is_asked_for() -> None:
    guidance = preview()
    guidance.reference(along(1.0))
    np.testing.assert_allclose(guidance.reference(along(1.2, left=0.3)).tractor.samples[:, 1], 0.0, atol=1e-9)
    guidance.rejoin()
    assert guidance.reference(along(1.4, left=0.3)).tractor.samples[0, 1] == pytest.approx(0.3, abs=1e-9)


def test_a_join_continues_beside_a_path_that_counts_from_elsewhere() -> None:
    nodes = EIGHT.nodes[20:].copy()
    nodes[:, 0] -= nodes[0, 0]
    later, begins = replace(EIGHT, nodes=nodes), EIGHT.nodes[20, 0]
    changed, unchanged = begun_at(Preview, 8.0, start=8.0), begun_at(Preview, 8.0, start=8.0)
    for each in (changed, unchanged):
        each.reference(along(8.0, left=0.3))
    assert changed.change(later, 8.0 - begins, along(8.0, left=0.3)) is GuidanceStatus.FINE
    for s in np.arange(8.2, 14.0, 0.2):
        one, other = (each.reference(along(float(s), left=0.2)) for each in (changed, unchanged))
        assert one.tractor.progress == pytest.approx(other.tractor.progress - begins)
        np.testing.assert_allclose(one.tractor.samples, other.tractor.samples, atol=1e-9)


def laid(pose: Pose, s: float) -> Path:
    """Return the eight, laid so that it is at a pose at an arc length (m)."""
    x, y, yaw, _ = EIGHT.sample(np.array([s]))[0].tolist()
    turn = complex(math.cos(pose.yaw - yaw), math.sin(pose.yaw - yaw))
    moved = complex(pose.x, pose.y) + turn * (EIGHT.nodes[:, 1:3] @ [1.0, 1.0j] - complex(x, y))
    nodes = np.column_stack([EIGHT.nodes[:, 0], moved.real, moved.imag, EIGHT.nodes[:, 3] + pose.yaw - yaw])
    return replace(EIGHT, nodes=nodes)


def under_way(kind: type[Guidance], s: float) -> Guidance:
    """Return guidance that has come along the path to an arc length."""
    guidance = begun_at(kind, s - 2.0, start=s - 2.0)
    for place in np.arange(s - 2.0, s + 0.1, 0.2):
        guidance.reference(along(float(place)))
    return guidance


@KINDS
@pytest.mark.parametrize("left", [0.0, -0.95])
def test_a_path_under_the_vehicle_is_gone_on_along(kind: type[Guidance], left: float) -> None:
    guidance = under_way(kind, 20.0)
    other = laid(beside(EIGHT, 20.0, -left), 3.0)  # the vehicle is to its left
    assert guidance.change(other, 3.5, along(20.0)) is GuidanceStatus.FINE
    reference = guidance.reference(estimate(beside(other, 3.0, left), beside(other, 3.0 - TRAILER_BEHIND, 0.1)))
    ahead = 0.0 if kind is Preview else SETTINGS.look_ahead
    for body, s, error in ((reference.tractor, 3.0, left), (reference.trailer, 3.0 - TRAILER_BEHIND, 0.1)):
        assert (body.progress, body.lateral_error) == pytest.approx((s, error), abs=1e-6)
        assert body.samples[0] == pytest.approx(other.sample(np.array([s + ahead]))[0], abs=1e-6)
    for s in np.arange(3.2, EIGHT.length + 0.2, 0.2):
        assert not guidance.finished
        guidance.reference(estimate(beside(other, float(s), 0.0), beside(other, float(s) - TRAILER_BEHIND, 0.0)))
    assert guidance.finished


def test_turns_end_where_a_path_lies_under_the_vehicle() -> None:
    guidance, away = preview(), facing(0.0, math.pi)
    assert np.abs(guidance.reference(away).tractor.samples[:, 1]).max() > 0.1
    back = laid(away.tractor, 5.0)
    assert guidance.change(back, 5.0, away) is GuidanceStatus.FINE
    samples = guidance.reference(away).tractor.samples
    np.testing.assert_allclose(samples[:, :2], back.sample(5.0 + 0.9 * 0.2 * np.arange(16))[:, :2], atol=1e-6)


HERE = beside(EIGHT, 20.0, 0.0)
BEHIND = beside(EIGHT, 20.0 - TRAILER_BEHIND, 0.0)
FAR, NOWHERE = GuidanceStatus.FAR_FROM_START, GuidanceStatus.POSE_NOT_FINITE
NO_NUMBER = Pose(x=math.nan, y=0.0, yaw=0.0)


@KINDS
@pytest.mark.parametrize(
    ("path", "at", "poses", "status"),
    [
        (laid(beside(EIGHT, 20.0, 1.05), 3.0), 3.0, (HERE, BEHIND), FAR),
        (laid(beside(EIGHT, 20.0, -1.05), 3.0), 3.0, (HERE, BEHIND), FAR),
        (laid(replace(HERE, yaw=HERE.yaw + 1.06), 3.0), 3.0, (HERE, BEHIND), FAR),
        (laid(replace(HERE, yaw=HERE.yaw - 1.06), 3.0), 3.0, (HERE, BEHIND), FAR),
        (laid(HERE, 3.0), 8.5, (HERE, BEHIND), FAR),
        (EIGHT, 70.0, (HERE, BEHIND), FAR),
        (laid(HERE, 3.0), 3.0, (NO_NUMBER, BEHIND), FAR),
        (laid(HERE, 3.0), 3.0, (replace(HERE, yaw=math.nan), BEHIND), FAR),
        (laid(HERE, 3.0), 3.0, (HERE, NO_NUMBER), NOWHERE),
    ],
    ids=["right", "left", "facing-left", "facing-right", "behind", "elsewhere", "nowhere", "no-yaw", "no-trailer"],
)
def test_a_path_elsewhere_is_refused_and_nothing_changes(
    kind: type[Guidance], path: Path, at: float, poses: tuple[Pose, Pose], status: GuidanceStatus
) -> None:
    guidance = under_way(kind, 20.0)
    before = guidance.live.memory.tobytes()
    assert guidance.change(path, at, estimate(*poses)) is status
    assert guidance.live.memory.tobytes() == before
    assert guidance.reference(along(20.2)).tractor.progress == pytest.approx(20.2, abs=1e-6)


@KINDS
def test_up_to_a_metre_and_sixty_degrees_a_path_is_under_the_vehicle(kind: type[Guidance]) -> None:
    for pose in (beside(EIGHT, 20.0, 0.95), *(replace(HERE, yaw=HERE.yaw + turn) for turn in (-1.04, 1.04))):
        assert under_way(kind, 20.0).change(laid(pose, 3.0), 3.0, along(20.0)) is GuidanceStatus.FINE
