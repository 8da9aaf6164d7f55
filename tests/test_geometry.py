import csv
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drawbar.geometry import arm_offset, east_north, nearest_branch, wrap

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


def geocentric(latitude: float, longitude: float) -> np.ndarray:
    """Return the WGS84 point at height zero in Cartesian coordinates, m."""
    axis, eccentricity_squared = 6378137.0, 6.69437999014e-3
    phi, lam = math.radians(latitude), math.radians(longitude)
    normal = axis / math.sqrt(1.0 - eccentricity_squared * math.sin(phi) ** 2)
    return normal * np.array(
        [
            math.cos(phi) * math.cos(lam),
            math.cos(phi) * math.sin(lam),
            (1.0 - eccentricity_squared) * math.sin(phi),
        ]
    )


@pytest.mark.parametrize("latitude", [-60.0, -20.0, 0.0, 35.0, 53.4, 65.0])
def test_tangent_plane_agrees_with_the_ellipsoid_in_space(latitude: float) -> None:
    longitude = 11.2
    phi, lam = math.radians(latitude), math.radians(longitude)
    east = np.array([-math.sin(lam), math.cos(lam), 0.0])
    north = np.array([-math.sin(phi) * math.cos(lam), -math.sin(phi) * math.sin(lam), math.cos(phi)])
    for bearing in np.linspace(0.0, 2.0 * math.pi, 9):
        there = (latitude + 2e-3 * math.sin(bearing), longitude + 2e-3 * math.cos(bearing))  # about 220 m
        away = geocentric(*there) - geocentric(latitude, longitude)
        measured = east_north(np.array(there[0]), np.array(there[1]), (latitude, longitude))
        assert np.allclose(measured, (away @ east, away @ north), rtol=0.0, atol=0.01)


def test_east_and_north_are_where_the_words_say() -> None:
    east, north = east_north(np.array([50.001, 50.0]), np.array([8.0, 8.001]), (50.0, 8.0))
    assert east[0] == 0.0
    assert north[0] > 100.0
    assert north[1] == 0.0
    assert east[1] > 60.0


_GOLDEN = Path(__file__).parents[2] / "shared" / "vectors" / "lever_arm.csv"


@pytest.mark.skipif(not _GOLDEN.is_file(), reason="the golden lever arms are not on this machine")
def test_arms_are_those_of_the_golden_file() -> None:
    for row in csv.DictReader(_GOLDEN.read_text("utf-8").splitlines()):
        value = {key: float(text) for key, text in row.items()}
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
