import ctypes
import math

import numpy as np
import pytest

from drawbar.codegen import build
from drawbar.codegen.library import load
from drawbar.errors import PathError
from drawbar.geometry import Floats
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.importers.line import RecordedLine
from drawbar.guidance.path import PATH_UNIT, PIECE_LENGTH, CPath, Path
from drawbar.guidance.settings import LineLimits
from drawbar.guidance.smoothing import make_drivable

RADIUS = 6.67


def arc(radius: float, yaw: float = 0.0, x: float = 0.0, y: float = 0.0, mirror: float = 1.0) -> Path:
    """A quarter-piece-spaced arc of 20 m that starts at (x, y) with the given yaw; mirror -1 turns right."""
    s = np.arange(0.0, 20.0, PIECE_LENGTH)
    angle = mirror * s / radius
    east, north = radius * np.sin(np.abs(angle)), mirror * radius * (1.0 - np.cos(angle))
    return Path.through(
        arc_length=s,
        x=x + math.cos(yaw) * east - math.sin(yaw) * north,
        y=y + math.sin(yaw) * east + math.cos(yaw) * north,
        yaw=yaw + angle,
        label_of_piece=np.zeros(len(s) - 1, dtype=np.int8),
        label_names=("arc",),
    )


def test_samples_of_an_arc_are_on_the_circle() -> None:
    s = np.linspace(0.0, 19.5, 1237)
    samples = arc(RADIUS).sample(s)
    np.testing.assert_allclose(samples[:, 0], RADIUS * np.sin(s / RADIUS), atol=1e-7, rtol=0)
    np.testing.assert_allclose(samples[:, 1], RADIUS * (1.0 - np.cos(s / RADIUS)), atol=1e-7, rtol=0)
    np.testing.assert_allclose(samples[:, 2], s / RADIUS, atol=1e-6, rtol=0)
    np.testing.assert_allclose(samples[:, 3], 1.0 / RADIUS, atol=5e-5, rtol=0)


def test_yaw_and_curvature_are_the_derivatives_of_the_position() -> None:
    path = figure_eights((8.0,), 20.0)
    step = 1e-4
    s = np.linspace(-3.0, path.length + 3.0, 4001)
    before, here, after = path.sample(s - step), path.sample(s), path.sample(s + step)
    slope = (after[:, :2] - before[:, :2]) / (2.0 * step)
    np.testing.assert_allclose(slope[:, 0], np.cos(here[:, 2]), atol=2e-5, rtol=0)
    np.testing.assert_allclose(slope[:, 1], np.sin(here[:, 2]), atol=2e-5, rtol=0)
    np.testing.assert_allclose(after[:, 2] - before[:, 2], 2.0 * step * here[:, 3], atol=2e-5, rtol=0)


def test_any_shape_of_arc_lengths_gives_the_same_samples() -> None:
    path = figure_eights((8.0,), 20.0)
    s = np.linspace(-3.0, path.length + 3.0, 60)
    np.testing.assert_array_equal(path.sample(s.reshape(2, 30)).reshape(60, 4), path.sample(s))


def test_both_ends_continue_as_straight_lines() -> None:
    path = arc(RADIUS)
    for end, beyond in ((0.0, -7.0), (path.length, path.length + 7.0)):
        (x, y, yaw, _), (x_b, y_b, yaw_b, curvature_b) = path.sample(np.array([end, beyond]))
        assert (yaw_b, curvature_b) == (pytest.approx(yaw, abs=1e-12), 0.0)
        assert x_b == pytest.approx(x + (beyond - end) * math.cos(yaw), abs=1e-12)
        assert y_b == pytest.approx(y + (beyond - end) * math.sin(yaw), abs=1e-12)


@pytest.mark.parametrize("distance", [-4.0, -0.3, -0.01, 0.0, 0.02, 0.5, 3.0])
@pytest.mark.parametrize("s", [-2.2, 0.0, 0.1, 5.123, 12.5, 19.0, 19.75, 22.0])
def test_projection_inverts_an_offset_along_the_normal(s: float, distance: float) -> None:
    path = arc(RADIUS)
    x, y, yaw, _ = path.sample(np.array([s]))[0]
    x, y = x - distance * math.sin(yaw), y + distance * math.cos(yaw)
    found, lateral = path.project(float(x), float(y), s - 1.0, s + 3.0)
    assert found == pytest.approx(s, abs=1e-6)
    assert lateral == pytest.approx(distance, abs=1e-6)


def test_projection_agrees_with_brute_force() -> None:
    rng = np.random.default_rng(7)  # seed 7
    path = figure_eights((10.0, 6.67), 20.0)
    for s in rng.uniform(0.0, path.length, 100):
        low, high = s - 1.0, s + 3.0
        grid = np.linspace(low, high, 40001)
        samples = path.sample(grid)
        x, y = path.sample(np.array([s + rng.uniform(-0.8, 2.8)]))[0, :2] + rng.uniform(-1.0, 1.0, 2)
        distance = np.hypot(samples[:, 0] - x, samples[:, 1] - y)
        found, lateral = path.project(float(x), float(y), low, high)
        x_f, y_f, _, _ = path.sample(np.array([found]))[0]
        assert math.hypot(x_f - x, y_f - y) <= distance.min() + 1e-9
        if low < found < high:
            assert abs(lateral) == pytest.approx(distance.min(), abs=1e-6)


def test_projection_stays_within_its_window() -> None:
    path = arc(RADIUS)
    assert path.project(100.0, 100.0, 3.0, 7.0)[0] in (3.0, 7.0)
    assert path.project(-50.0, 0.0, -1.0, 3.0) == (-1.0, 0.0)


def _moved(points: Floats, yaw: float) -> Floats:
    rotation = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    return points @ rotation.T + np.array([31.0, -17.0])


def test_rotating_translating_and_mirroring_the_world_changes_nothing() -> None:
    rng = np.random.default_rng(3)  # seed 3
    path = arc(RADIUS)
    turned = arc(RADIUS, yaw=2.5, x=31.0, y=-17.0)
    mirrored = arc(RADIUS, mirror=-1.0)
    for s in rng.uniform(1.0, 18.0, 50):
        point = path.sample(np.array([s]))[0, :2] + rng.uniform(-1.0, 1.0, 2)
        expected = path.project(float(point[0]), float(point[1]), s - 1.0, s + 3.0)
        x, y = _moved(point, 2.5).tolist()
        assert turned.project(x, y, s - 1.0, s + 3.0) == pytest.approx(expected, abs=1e-9)
        found, lateral = mirrored.project(float(point[0]), -float(point[1]), s - 1.0, s + 3.0)
        assert (found, -lateral) == pytest.approx(expected, abs=1e-9)


def test_labels_follow_the_pieces() -> None:
    path = figure_eights((8.0,), 20.0)
    assert path.labels(np.array([-5.0, 9.99, 10.01, path.length + 5.0])) == [
        "straight",
        "straight",
        "0.125",
        "straight",
    ]


def test_a_path_that_is_not_finite_or_does_not_advance_is_refused() -> None:
    good = {"x": np.zeros(3), "y": np.zeros(3), "yaw": np.zeros(3)}
    labels = {"label_of_piece": np.zeros(2, dtype=np.int8), "label_names": ("a",)}
    with pytest.raises(PathError, match=r"pose 2 of a path is .*nan.*; poses must be finite"):
        Path.through(arc_length=np.array([0.0, 1.0, np.nan]), **good, **labels)
    with pytest.raises(PathError, match="must begin at 0 and increase"):
        Path.through(arc_length=np.array([0.0, 1.0, 1.0]), **good, **labels)
    single = {name: values[:1] for name, values in good.items()}
    with pytest.raises(PathError, match="at least two poses, got 1"):
        Path.through(arc_length=np.zeros(1), **single, **labels)


CHECK = load(build("path_check", PATH_UNIT))


def first_wrong(nodes: Floats) -> int:
    return CHECK.drawbar_path_check(ctypes.byref(CPath(nodes)))


def recorded() -> Path:
    s = np.linspace(0.0, 60.0, 40)
    line = RecordedLine(name="wave", x=s, y=3.0 * np.sin(s / 9.0))
    return make_drivable(line, LineLimits(curvature=0.2, curvature_rate=0.3, tolerance=0.5)).path


@pytest.mark.parametrize("path", [figure_eights((10.0, 6.67, 3.0), 20.0), arc(2.5), arc(0.6), recorded()])
def test_a_path_passes_its_check(path: Path) -> None:
    assert first_wrong(path.nodes) == -1
    assert first_wrong(path.nodes[:2].copy()) == -1


@pytest.mark.parametrize("node", [1, 7, 79])
@pytest.mark.parametrize("column", range(4))
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 2e7, -1.0, 500.0])
def test_one_wrong_number_in_a_table_is_found_where_it_is(node: int, column: int, value: float) -> None:
    nodes = arc(RADIUS).nodes.copy()
    nodes[node, column] = value
    assert first_wrong(nodes) == node


@pytest.mark.parametrize(
    ("column", "step"),
    [(0, 0.1), (0, -0.251), (0, -0.2499), (1, 0.01), (2, 0.01), (2, -0.01), (3, 0.04), (3, -0.04), (3, 2.0 * math.pi)],
)
def test_a_table_that_jumps_is_found_where_it_does(column: int, step: float) -> None:
    nodes = arc(RADIUS).nodes.copy()
    nodes[12:, column] += step
    assert first_wrong(nodes) == 12


def test_a_table_is_refused_for_its_beginning_or_its_size() -> None:
    nodes = arc(RADIUS).nodes
    assert first_wrong(nodes + np.array([0.1, 0.0, 0.0, 0.0])) == 0
    assert first_wrong(nodes * np.array([1.0, math.nan, 1.0, 1.0])) == 0
    assert first_wrong(nodes[:1].copy()) == 0
    assert first_wrong(nodes[:0].copy()) == 0
    assert CHECK.drawbar_path_check(ctypes.byref(CPath.from_buffer_copy(bytes(ctypes.sizeof(CPath))))) == 0


@pytest.mark.parametrize("apart", [0.0005, 0.3])
def test_poses_too_close_together_or_too_far_apart_are_refused(apart: float) -> None:
    s = apart * np.arange(20.0)
    assert first_wrong(np.column_stack([s, s, 0.0 * s, 0.0 * s])) == 1


def test_a_table_that_bends_like_a_kink_is_refused() -> None:
    assert first_wrong(arc(0.49).nodes) == 1


def test_track_is_projected_as_its_places_are_one_by_one():
    path = figure_eights([5.0], 4.0)
    places = (
        path.sample(np.arange(0.0, path.length, 0.3))[:, :2]
        + 0.1 * np.sin(np.arange(1000))[: int(path.length / 0.3) + 1, None]
    )
    places[7] = np.nan
    found = zip(*path.project_track(*places.T, 0.0, behind=1.0, ahead=3.0), strict=True)
    last = 0.0
    for place, (progress, error) in zip(places, found, strict=True):
        if np.isnan(place).any():
            assert np.isnan([progress, error]).all()
            continue
        last, expected = path.project(*place.tolist(), last - 1.0, last + 3.0)
        assert (progress, error) == (last, expected)


@pytest.mark.parametrize("offset", [0.4, -2.5])
def test_a_parallel_line_is_so_far_from_the_path_everywhere_and_as_smooth(offset):
    path = figure_eights((8.0,), 20.0)
    beside = path.beside(offset)
    assert np.diff(beside.nodes[:, 0]).max() <= PIECE_LENGTH + 1e-9
    s = np.linspace(0.0, beside.length, 997)
    near = 0.0
    for x, y, yaw, curvature in beside.sample(s):
        near, lateral = path.project(float(x), float(y), near - 1.0, near + 3.0)
        assert lateral == pytest.approx(offset, abs=1e-3)
        of_path = path.sample(np.array([near]))[0]
        assert yaw == pytest.approx(of_path[2], abs=2e-3)
        if np.ptp(path.sample(np.array([near + 0.3, near - 0.3]))[:, 3]) < 0.01:  # not where it jumps
            assert curvature == pytest.approx(of_path[3] / (1.0 - offset * of_path[3]), abs=5e-3)
    ahead = np.gradient(beside.sample(s)[:, :2], s, axis=0)
    np.testing.assert_allclose(np.hypot(*ahead.T), 1.0, atol=1e-3)  # its arc length is one


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_parallel_line_inside_of_a_curve_that_is_tighter_is_refused_with_the_offset_that_is_allowed(side):
    path = figure_eights((8.0,), 20.0)
    with pytest.raises(PathError, match="curves too tightly") as refused:
        path.beside(side * 7.9)
    allowed = float(str(refused.value).split("less than ")[1].split()[0])
    path.beside(side * (allowed - 0.01))
    with pytest.raises(PathError, match="curves too tightly"):
        path.beside(side * (allowed + 0.01))


@pytest.mark.parametrize("offset", [math.nan, math.inf, "1"])
def test_a_parallel_line_so_far_beside_as_no_number_says_is_refused_as_that(offset):
    with pytest.raises(PathError, match="offset"):
        figure_eights((8.0,), 20.0).beside(offset)


def test_a_reversed_path_leads_from_the_end_to_the_start():
    path = arc(RADIUS)
    back = path.reversed()
    s = np.linspace(0.0, path.length, 50)
    there, again = path.sample(path.length - s), back.sample(s)
    np.testing.assert_allclose(again[:, :2], there[:, :2], atol=1e-9)
    np.testing.assert_allclose(again[:, 2], there[:, 2] + math.pi, atol=1e-9)
    np.testing.assert_allclose(again[1:-1, 3], -there[1:-1, 3], atol=1e-6)
