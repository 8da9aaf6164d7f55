import math

import numpy as np
import pytest

from drawbar.errors import PathError
from drawbar.geometry import Floats
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.path import PIECE_LENGTH, Path

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
    with pytest.raises(PathError, match="finite"):
        Path.through(arc_length=np.array([0.0, 1.0, np.nan]), **good, **labels)
    with pytest.raises(PathError, match="increases"):
        Path.through(arc_length=np.array([0.0, 1.0, 1.0]), **good, **labels)
