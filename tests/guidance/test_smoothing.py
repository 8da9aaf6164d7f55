import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drawbar.errors import PathError
from drawbar.geometry import Floats, LocalFrame
from drawbar.guidance.importers.line import RecordedLine
from drawbar.guidance.importers.load import load_line
from drawbar.guidance.settings import LineLimits
from drawbar.guidance.smoothing import DrivablePath, make_drivable

LIMIT, RATE = 0.3, 0.3


def line(x: Floats, y: Floats) -> RecordedLine:
    return RecordedLine(name="line", x=x, y=y)


def drivable(recorded: RecordedLine, tolerance: float = 0.6, limit: float = LIMIT) -> DrivablePath:
    return make_drivable(recorded, LineLimits(curvature=limit, curvature_rate=RATE, tolerance=tolerance))


def corner(degrees: float, arm: float = 40.0) -> RecordedLine:
    """Points 1 m apart along two straight arms that meet at the origin."""
    s = np.arange(-arm, arm + 1.0)
    after = np.maximum(s, 0.0) * np.exp(1j * math.radians(degrees))
    points = np.minimum(s, 0.0) + after
    return line(points.real, points.imag)


def assert_continuous_and_within(result: DrivablePath, limit: float) -> None:
    step = 0.01
    samples = result.path.sample(np.arange(0.0, result.path.length, step))
    assert np.abs(samples[:, 3]).max() <= limit
    # over a quarter metre: within a piece the path's cubic bends a little unevenly
    assert np.abs(samples[25:, 3] - samples[:-25, 3]).max() <= 1.01 * RATE * 0.25
    assert np.abs(np.diff(samples[:, 3])).max() <= 1.05 * RATE * step
    np.testing.assert_allclose(np.diff(samples[:, 2]), step * samples[:-1, 3], atol=5e-5)
    chords = np.hypot(*np.diff(samples[:, :2], axis=0).T)
    np.testing.assert_allclose(chords, step, atol=1e-6)


def independent_deviation(result: DrivablePath, x: float, y: float) -> float:
    """Distance of a point from the polyline through path points 1 cm apart."""
    samples = result.path.sample(np.arange(-1.0, result.path.length + 1.0, 0.01))
    nodes = samples[:, 0] + 1j * samples[:, 1]
    chords, offsets = np.diff(nodes), complex(x, y) - nodes[:-1]
    share = np.clip((offsets / chords).real, 0.0, 1.0)
    return float(np.abs(offsets - share * chords).min())


def test_a_path_keeps_the_frame_of_its_line() -> None:
    frame = LocalFrame(latitude=50.8, longitude=4.7)
    assert drivable(replace(corner(0.0), frame=frame)).frame == frame
    assert drivable(corner(0.0)).frame is None


def test_the_recorded_lines_become_drivable(recorded_line: tuple[Path, str]) -> None:
    recorded = load_line(*recorded_line)
    result = drivable(recorded)
    assert_continuous_and_within(result, LIMIT)
    for index in [int(result.deviations.argmax()), *range(0, len(recorded.x), 50)]:
        independent = independent_deviation(result, float(recorded.x[index]), float(recorded.y[index]))
        assert result.deviations[index] == pytest.approx(independent, abs=1e-4)
    assert result.deviations.max() <= 0.50
    assert result.deviations.mean() <= 0.013


def test_outside_the_kinks_the_path_stays_on_the_recorded_points(recorded_line: tuple[Path, str]) -> None:
    recorded = load_line(*recorded_line)
    result = drivable(recorded)
    for x, y, deviation in zip(recorded.x, recorded.y, result.deviations, strict=True):
        guess = np.arange(0.0, result.path.length, 0.25)
        samples = result.path.sample(guess)
        s = guess[np.hypot(samples[:, 0] - x, samples[:, 1] - y).argmin()]
        if result.path.labels(np.array([s])) != ["kink"]:
            assert deviation <= 0.10


@pytest.mark.parametrize("limit", [0.25, 0.3, 0.4])
@pytest.mark.parametrize("degrees", [45.0, -84.0])
def test_a_corner_costs_little_more_than_geometry_demands(degrees: float, limit: float) -> None:
    """An arc of radius R that misses both arms and their corner by e has e = R tan²(turn / 4)."""
    result = drivable(corner(degrees), tolerance=1.0, limit=limit)
    least = math.tan(math.radians(degrees) / 4.0) ** 2 / limit
    assert_continuous_and_within(result, limit)
    assert result.deviations.max() <= 1.10 * least + 0.01
    assert result.path.labels(np.array([5.0, result.path.length / 2.0])) == ["straight", "kink"]


def test_a_line_that_is_too_tight_is_refused_with_place_and_amount() -> None:
    with pytest.raises(PathError, match=r"point 41 at \(0\.00, 0\.00\) m is 0\.\d+ m .* 0\.3 m is allowed"):
        drivable(corner(90.0), tolerance=0.3)


def test_a_line_that_turns_back_on_itself_is_refused() -> None:
    with pytest.raises(PathError, match="line 'line'"):
        drivable(corner(180.0))


def zigzag(corners: int) -> RecordedLine:
    """Corners of 60°, 10 m apart."""
    heading = np.where(np.arange(corners) % 2, 1.0, -1.0) * math.radians(30.0)
    points = np.concatenate([[0.0], np.cumsum(10.0 * np.exp(1j * heading))])
    return line(points.real, points.imag)


def test_kinks_in_a_row_are_smoothed_together_but_not_without_end() -> None:
    assert_continuous_and_within(drivable(zigzag(20)), LIMIT)
    endless = zigzag(220)
    with pytest.raises(PathError, match=r"from \(0\.0, 0\.0\) m on; at most 2000 m of kinks in a row"):
        drivable(line(endless.x - 1e-9, endless.y))


def test_mirroring_and_turning_the_line_mirrors_and_turns_the_path() -> None:
    recorded = corner(60.0)
    points = (recorded.x + 1j * recorded.y).conj() * np.exp(1j) + (20.0 - 7.0j)
    there, here = drivable(line(points.real, points.imag)), drivable(recorded)
    assert there.path.length == pytest.approx(here.path.length, abs=1e-3)
    s = np.linspace(0.0, here.path.length, 100)
    expected, samples = here.path.sample(s), there.path.sample(s)
    moved = (expected[:, 0] - 1j * expected[:, 1]) * np.exp(1j) + (20.0 - 7.0j)
    np.testing.assert_allclose(samples[:, 0] + 1j * samples[:, 1], moved, atol=2e-3)
    np.testing.assert_allclose(samples[:, 2], 1.0 - expected[:, 2], atol=2e-3)


def test_a_straight_line_of_two_points_stays_straight() -> None:
    result = drivable(line(np.array([1.0, 31.0]), np.array([2.0, 42.0])))
    assert result.path.length == pytest.approx(50.0, abs=1e-9)
    samples = result.path.sample(np.linspace(-5.0, 60.0, 66))
    np.testing.assert_allclose(samples[:, 2], math.atan2(40.0, 30.0), atol=1e-9)
    np.testing.assert_allclose(samples[:, 3], 0.0, atol=1e-9)
    assert set(result.path.labels(samples[:, 0])) == {"straight"}


@pytest.mark.parametrize("length", [3e-4, 0.1, 0.3, 1.0])
def test_a_line_shorter_than_a_detail_keeps_its_ends_and_direction(length: float) -> None:
    points = np.array([1.0, 1.0 + 0.25j * length, 1.0 + 1j * length])
    result = drivable(line(points.real, points.imag), tolerance=1e-6)
    assert result.path.length == pytest.approx(length, rel=1e-6)
    np.testing.assert_allclose(result.path.sample(np.array([0.5 * length]))[0, 2], 0.5 * math.pi, atol=1e-5)


def test_the_recorded_points_stay_with_the_path() -> None:
    recorded = corner(30.0)
    result = drivable(recorded)
    assert result.recorded.shape == (*result.deviations.shape, 2)
    np.testing.assert_array_equal(result.recorded.T, [recorded.x, recorded.y])


def test_a_refused_place_west_of_the_origin_by_a_hair_is_not_minus_zero() -> None:
    recorded = corner(90.0)
    with pytest.raises(PathError, match=r"at \(0\.00, 0\.00\) m"):
        drivable(line(recorded.x - 1e-9, recorded.y - 1e-9), tolerance=0.3)


def test_a_circle_keeps_its_radius() -> None:
    angle = np.linspace(0.0, 1.9 * math.pi, 120)
    result = drivable(line(10.0 * np.cos(angle), 10.0 * np.sin(angle)), tolerance=0.02)
    samples = result.path.sample(np.linspace(2.0, result.path.length - 2.0, 500))
    np.testing.assert_allclose(np.hypot(samples[:, 0], samples[:, 1]), 10.0, atol=0.01)
    np.testing.assert_allclose(samples[:, 3], 0.1, atol=0.005)


def test_measurement_noise_does_not_become_curvature() -> None:
    rng = np.random.default_rng(5)  # seed 5
    x = np.arange(0.0, 200.0)
    result = drivable(line(x, rng.normal(0.0, 0.02, len(x))), tolerance=0.1)
    assert_continuous_and_within(result, 0.1)


def test_a_line_that_crosses_itself_keeps_both_branches() -> None:
    angle = np.linspace(0.1, 2.0 * math.pi + 0.1, 200)
    recorded = line(30.0 * np.sin(angle), 20.0 * np.sin(2.0 * angle))
    result = drivable(recorded, tolerance=0.05)
    assert_continuous_and_within(result, LIMIT)


def test_a_crossing_between_kinks_does_not_mix_up_the_branches() -> None:
    corners = np.array([-20.0, 8.0, 8.0 + 8.0j, 8.0j, -20.0j])
    along = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(corners)))])
    points = np.interp(np.arange(0.0, along[-1], 0.5), along, corners)
    result = drivable(line(points.real, points.imag), tolerance=0.65)
    assert_continuous_and_within(result, LIMIT)
    assert result.path.length == pytest.approx(along[-1], abs=5.0)


def test_a_kinks_label_reaches_a_vehicle_length_behind_it() -> None:
    path = drivable(corner(60.0)).path
    s = np.arange(0.0, path.length, 0.1)
    samples = path.sample(s)
    left = (samples[:, 0] + 1j * samples[:, 1]) * np.exp(-1j * math.radians(60.0))
    disturbed = s[(np.abs(left.imag) > 0.06) & (left.real > 0.0)].max()
    assert path.labels(np.array([disturbed + 3.5, disturbed + 6.0])) == ["kink", "straight"]


def test_a_line_of_a_hundred_thousand_points_keeps_constant_look_ups() -> None:
    s = np.arange(1e5)
    path = drivable(line(s, 20.0 * np.sin(s / 60.0)), tolerance=0.01).path
    x, y, _, _ = path.sample(np.array([5e4]))[0].tolist()
    assert path.project(x, y, 5e4 - 1.0, 5e4 + 3.0)[0] == pytest.approx(5e4, abs=1e-6)
