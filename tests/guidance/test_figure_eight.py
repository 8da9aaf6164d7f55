import math

import numpy as np
import pytest

from drawbar.errors import PathError
from drawbar.guidance.figure_eight import figure_eights

RADII = (10.0, 8.0, 6.67)


def eight_length(radius: float) -> float:
    return 40.0 + 2.0 * radius * (math.pi + 2.0 * math.atan(radius / 10.0))


def test_length_is_that_of_the_arcs_and_straights() -> None:
    assert figure_eights(RADII, 20.0).length == pytest.approx(sum(map(eight_length, RADII)), abs=1e-9)


@pytest.mark.parametrize("radius", RADII)
def test_an_eight_closes_at_the_crossing_with_its_first_heading(radius: float) -> None:
    path = figure_eights((radius,), 20.0)
    start, end = path.sample(np.array([0.0, path.length]))
    np.testing.assert_allclose(end[:3], start[:3], atol=1e-10)


@pytest.mark.parametrize("radius", RADII)
def test_the_middle_of_the_long_straight_is_the_crossing(radius: float) -> None:
    x, y, yaw, _ = figure_eights((radius,), 20.0).sample(np.array([eight_length(radius) / 2.0]))[0]
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-10)
    assert yaw == pytest.approx(math.pi + 2.0 * math.atan(radius / 10.0), abs=1e-10)


def test_a_radius_of_half_the_straight_turns_by_270_degrees() -> None:
    path = figure_eights((10.0,), 20.0)
    yaw = path.sample(np.linspace(0.0, path.length, 20001))[:, 2]
    assert yaw.max() == pytest.approx(math.radians(270.0), abs=1e-6)
    assert np.abs(np.diff(yaw)).max() < 0.01  # continuous: no wrap


def test_arcs_are_circles_left_first() -> None:
    path = figure_eights((8.0,), 20.0)
    arc = 8.0 * (math.pi + 2.0 * math.atan(0.8))
    left = path.sample(10.0 + np.linspace(0.0, arc, 500))
    np.testing.assert_allclose(np.hypot(left[:, 0] - 10.0, left[:, 1] - 8.0), 8.0, atol=1e-7)
    right = path.sample(30.5 + arc + np.linspace(0.0, arc - 1.0, 500))
    np.testing.assert_allclose(right[:, 3], -1.0 / 8.0, atol=5e-5)


def test_labels_name_the_papers_curvatures() -> None:
    path = figure_eights(RADII, 20.0)
    labels = path.labels(np.linspace(0.0, path.length, 3000))
    assert set(labels) == {"straight", "0.1", "0.125", "0.15"}
    assert labels.count("straight") / 3000 == pytest.approx(120.0 / path.length, abs=1e-3)


@pytest.mark.parametrize(("radii", "straight"), [((-1.0,), 20.0), ((math.nan,), 20.0), ((8.0,), 0.0), ((), 20.0)])
def test_impossible_lengths_are_refused(radii: tuple[float, ...], straight: float) -> None:
    with pytest.raises(PathError, match="figure-eight"):
        figure_eights(radii, straight)
