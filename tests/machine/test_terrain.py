"""The ground's height: its plane, its spread, its spectrum, and how bodies stand on it."""

import math

import numpy as np
import pytest

from drawbar.machine.attitude import Attitude
from drawbar.machine.plant import STATES
from drawbar.machine.settings import BodySettings, TerrainSettings
from drawbar.machine.terrain import Terrain
from drawbar.vehicle.parameters import VehicleParameters


def terrain(seed: int = 0, **settings: float) -> Terrain:
    return Terrain(TerrainSettings(**settings), np.random.default_rng(seed))


def test_plane_falls_downhill_and_across() -> None:
    plane = terrain(slope=0.1, downhill=math.radians(-90.0))
    heights = plane.height(np.array([0.0, 7.0, 0.0]), np.array([0.0, 0.0, -10.0]))
    np.testing.assert_allclose(heights, [0.0, 0.0, -10.0 * math.tan(0.1)], atol=1e-12)
    assert plane.across(0.0) == pytest.approx(-0.1)  # facing east, the slope falls to the right
    assert plane.across(math.pi) == pytest.approx(0.1)
    assert plane.across(-0.5 * math.pi) == pytest.approx(0.0, abs=1e-12)


def test_unevenness_has_its_deviation_and_its_spectrum() -> None:
    x = np.arange(0.0, 2000.0, 0.1)
    sections = [terrain(seed, unevenness=0.04).height(x, np.full_like(x, 3.0)) for seed in range(8)]
    assert np.mean([section.std() for section in sections]) == pytest.approx(0.04, rel=0.05)
    density = np.mean([np.abs(np.fft.rfft(section)) ** 2 for section in sections], axis=0)
    frequency = np.fft.rfftfreq(len(x), 0.1)
    power = [density[(low <= frequency) & (frequency < high)].sum() for low, high in ((0, 0.5), (0.5, 6.0))]
    assert power[1] < 0.01 * power[0]  # nothing is shorter than 2 m
    slow, fast = (density[(low <= frequency) & (frequency < 1.3 * low)].mean() for low in (0.1, 0.3))
    assert slow / fast == pytest.approx(9.0, rel=0.5)  # falls with the square of the wave number


def test_bodies_on_a_plane_stand_as_the_plane_does() -> None:
    slope, yaw, trailer_yaw = 0.08, 0.7, 0.2
    plane, vehicle = terrain(slope=slope, downhill=-0.5 * math.pi), VehicleParameters()
    state = np.zeros(STATES)
    state[2:4] = yaw, trailer_yaw
    rise = math.tan(slope)
    angles = Attitude(vehicle, BodySettings(), plane, 0.01, state).angles
    # nose up where the body climbs, right down where the left is higher: the plane's rise along each axis
    expected = (rise * math.cos(yaw), rise * math.sin(yaw))
    np.testing.assert_allclose(np.tan(angles[:2]), expected, atol=1e-12)
    assert math.tan(angles[2]) == pytest.approx(rise * math.cos(trailer_yaw))
    level = Attitude(vehicle, BodySettings(), terrain(), 0.01, state).angles
    assert not level.any()


def test_bodies_follow_the_ground_through_their_lag() -> None:
    plane, settings = terrain(slope=0.08), BodySettings(tractor_suspension=0.5)
    facing_up, facing_east = np.zeros(STATES), np.zeros(STATES)
    facing_up[2:4] = 0.5 * math.pi
    attitude = Attitude(VehicleParameters(), settings, plane, 0.01, facing_up)
    angles = attitude.advance(np.tile(facing_east, (50, 1)))
    share = -np.expm1(-0.01 * np.arange(1, 51) / 0.5)
    np.testing.assert_allclose(angles[:, 0], 0.08 * share, atol=1e-9)
    np.testing.assert_allclose(attitude.angles, angles[-1])


def test_tangents_touch_the_ground() -> None:
    settings = TerrainSettings(slope=0.1, downhill=0.7, unevenness=0.05)
    terrain, step = Terrain(settings, np.random.default_rng(1)), 1e-5
    x, y = np.random.default_rng(2).uniform(-30.0, 30.0, (2, 40))
    height, east, north = terrain.tangents(x, y).T
    assert height + east * x + north * y == pytest.approx(terrain.height(x, y), abs=1e-12)
    assert east == pytest.approx((terrain.height(x + step, y) - terrain.height(x - step, y)) / (2.0 * step), abs=1e-7)
    assert north == pytest.approx((terrain.height(x, y + step) - terrain.height(x, y - step)) / (2.0 * step), abs=1e-7)
