import math

import numpy as np
import pytest
from golden import rows
from hypothesis import given
from hypothesis import strategies as st

from drawbar.geometry import LocalFrame, arm_offset, nearest_branch, wrap

angles = st.floats(-1e3, 1e3)


@given(angles)
def test_wrap_keeps_the_direction_and_lands_in_its_range(angle: float) -> None:
    wrapped = wrap(angle)
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-12)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-12)


def test_wrap_at_its_ends() -> None:
    assert wrap(math.pi) == -math.pi
    assert wrap(-math.pi) == -math.pi
    assert wrap(0.0) == 0.0


@given(angles, angles)
def test_nearest_branch_moves_by_whole_turns_to_within_half_a_turn(angle: float, target: float) -> None:
    moved = nearest_branch(angle, target)
    turns = (moved - angle) / (2.0 * math.pi)
    assert turns == pytest.approx(round(turns), abs=1e-9)
    assert abs(moved - target) <= math.pi + 1e-9


ORIGINS = [(-60.0, 11.2, 0.0), (-20.0, -179.99, 300.0), (0.0, 0.0, 0.0), (50.88, 4.7, 88.0), (67.0, 25.0, 150.0)]


def test_the_frame_gives_the_golden_coordinates() -> None:
    for row in rows("enu.csv"):
        frame = LocalFrame(
            latitude=row["origin_latitude_deg"], longitude=row["origin_longitude_deg"], height=row["origin_height_m"]
        )
        point = frame.east_north_up(row["latitude_deg"], row["longitude_deg"], row["height_m"])
        np.testing.assert_allclose(point, (row["east_m"], row["north_m"], row["up_m"]), rtol=0.0, atol=5.1e-5)


def around(origin: tuple[float, float, float], distance: float) -> np.ndarray:
    """Return longitudes, latitudes, heights (n, 3) of points around an origin, up to a distance away, m."""
    generator = np.random.default_rng(0)
    bearing, radius = generator.uniform(0.0, 2.0 * math.pi, 200), generator.uniform(0.0, distance, 200)
    latitude = origin[0] + radius * np.sin(bearing) / 111e3
    longitude = origin[1] + radius * np.cos(bearing) / 111e3 / math.cos(math.radians(origin[0]))
    return np.column_stack([longitude, latitude, origin[2] + generator.uniform(-50.0, 50.0, 200)])


@pytest.mark.parametrize("origin", ORIGINS)
def test_the_frame_is_the_topocentric_one_of_proj(origin: tuple[float, float, float]) -> None:
    pyproj = pytest.importorskip("pyproj")
    latitude, longitude, height = origin
    there = pyproj.Transformer.from_pipeline(
        "+proj=pipeline +step +proj=cart +ellps=WGS84 +step +proj=topocentric +ellps=WGS84 "
        f"+lat_0={latitude} +lon_0={longitude} +h_0={height}"
    )
    points = around(origin, 5000.0)
    theirs = np.array([there.transform(*point) for point in points])
    frame = LocalFrame(latitude=latitude, longitude=longitude, height=height)
    ours = np.column_stack(frame.east_north_up(points[:, 1], points[:, 0], points[:, 2]))
    np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("origin", ORIGINS)
def test_the_frame_turns_back_into_degrees(origin: tuple[float, float, float]) -> None:
    latitude, longitude, height = origin
    frame = LocalFrame(latitude=latitude, longitude=longitude, height=height)
    points = around(origin, 5000.0)
    local = frame.east_north_up(points[:, 1], points[:, 0], points[:, 2])
    again = frame.east_north_up(*frame.wgs84(*local))
    np.testing.assert_allclose(again, local, rtol=0.0, atol=1e-8)
    level = frame.east_north(*frame.level(local[0], local[1]))
    np.testing.assert_allclose(level, local[:2], rtol=0.0, atol=1e-8)


def test_fixes_and_lines_of_one_place_agree_whatever_their_heights() -> None:
    frame = LocalFrame(latitude=50.88, longitude=4.7)
    line = frame.east_north(50.92, 4.75)
    north = frame.east_north_up(50.92, 4.75, 100.0)[1]
    assert line[1] == pytest.approx(float(north), abs=0.1)
    assert line[1] != pytest.approx(float(north), abs=0.01)  # why a fix's height is left out


def test_east_and_north_are_where_the_words_say() -> None:
    east, north = LocalFrame(latitude=50.0, longitude=8.0).east_north(np.array([50.001, 50.0]), np.array([8.0, 8.001]))
    assert east[0] == pytest.approx(0.0, abs=1e-9)
    assert north[0] > 100.0
    assert north[1] == pytest.approx(0.0, abs=1e-3)
    assert east[1] > 60.0


def test_arms_are_those_of_the_golden_file() -> None:
    for value in rows("lever_arm.csv"):
        arm = (value["arm_forward_m"], value["arm_left_m"], value["arm_up_m"])
        east, north = arm_offset(value["yaw_rad"], value["roll_right_rad"], value["pitch_up_rad"], arm)
        ground = value["antenna_east_m"] - east, value["antenna_north_m"] - north
        assert ground == pytest.approx((value["ground_east_m"], value["ground_north_m"]), abs=1e-6)


@given(angles, st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.tuples(*[st.floats(-3.0, 3.0)] * 3))
def test_an_arm_is_turned_as_three_rotations_turn_it(
    yaw: float, roll: float, pitch: float, arm: tuple[float, float, float]
) -> None:
    def about(axis: int, angle: float) -> np.ndarray:
        turn, (i, j) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
        turn[i, i] = turn[j, j] = math.cos(angle)
        turn[i, j], turn[j, i] = -math.sin(angle), math.sin(angle)
        return turn

    expected = about(2, yaw) @ about(1, -pitch) @ about(0, roll) @ np.array(arm)
    assert arm_offset(yaw, roll, pitch, arm) == pytest.approx(expected[:2].tolist(), abs=1e-9)
