"""Turns against a straightforward integration, and the ways onto a line and onto a path that they make up."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drawbar.errors import PathError
from drawbar.guidance.approach import find_approach, turns_onto_line
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.path import Path
from drawbar.guidance.turns import TurnLimits, trace
from drawbar.signals import Pose

LIMITS = TurnLimits(curvature=0.3, rate=0.25)
EIGHT = figure_eights((8.0,), 20.0)
ANGLES = (0.02, 0.3, 1.0, math.pi, 5.0)
STARTS = [(0.0, math.pi), (0.0, -2.5), (1.5, 2.0), (-1.0, -2.4), (0.0, 1.5), (2.0, 0.0)]


def driven(angle: float) -> tuple[complex, float, float]:
    """Return end point, length and largest curvature of one turn to the left, integrated from its definition."""
    peak = min(LIMITS.curvature, math.sqrt(LIMITS.rate * angle))
    length = angle / peak + peak / LIMITS.rate

    def rates(s, state):
        curvature = min(LIMITS.rate * s, peak, LIMITS.rate * (length - s))
        return [math.cos(state[2]), math.sin(state[2]), curvature]

    end = solve_ivp(rates, (0.0, length), [0.0, 0.0, 0.0], rtol=1e-10, atol=1e-12, max_step=0.05).y[:, -1]
    assert end[2] == pytest.approx(angle, abs=1e-6)
    return complex(end[0], end[1]), length, peak


@pytest.mark.parametrize("angle", ANGLES)
def test_chord_length_and_peak_are_those_of_the_curve(angle: float) -> None:
    end, length, peak = driven(angle)
    for signed in (angle, -angle):
        assert LIMITS.peak(np.array(signed)) == pytest.approx(peak)
        assert LIMITS.length(np.array(signed)) == pytest.approx(length)
        assert LIMITS.chord(np.array(signed)) * np.exp(0.5j * angle) == pytest.approx(end, abs=1e-6)


@pytest.mark.parametrize("angle", ANGLES)
def test_trace_is_the_curve(angle: float) -> None:
    end, _, _ = driven(angle)
    left = trace(LIMITS, np.array([angle]), heading=0.0, curvature=0.0)
    assert left.points[-1] == pytest.approx(end, abs=1e-5)
    assert left.heading[-1] == pytest.approx(angle)
    right = trace(LIMITS, np.array([-angle]), heading=0.7, curvature=0.0)
    np.testing.assert_allclose(right.points, np.exp(0.7j) * left.points.conj(), atol=1e-12)


def test_wheels_that_are_turned_are_brought_straight_first() -> None:
    ramp = trace(LIMITS, np.zeros(0), heading=0.0, curvature=-0.3)
    assert ramp.heading[-1] == pytest.approx(-0.5 * 0.3**2 / LIMITS.rate)


@pytest.mark.parametrize(("offset", "heading"), STARTS)
def test_turns_end_on_the_line_in_its_direction(offset: float, heading: float) -> None:
    found = turns_onto_line(offset, heading, LIMITS)
    lengths = LIMITS.length(found).sum(axis=1)
    assert (np.diff(lengths) >= 0.0).all()
    for angles in found[:5]:
        way = trace(LIMITS, angles, heading=heading, curvature=0.0)
        assert offset + way.points[-1].imag == pytest.approx(0.0, abs=1e-4)
        assert math.cos(way.heading[-1]) == pytest.approx(1.0)


def test_the_mirrored_start_takes_the_mirrored_turns() -> None:
    here, there = turns_onto_line(1.5, 2.0, LIMITS), turns_onto_line(-1.5, -2.0, LIMITS)
    np.testing.assert_allclose(there[0], -here[0], atol=1e-9)


def approached(path: Path, pose: Pose, near: float, curvature: float = 0.0, room: float = 5.5) -> np.ndarray:
    approach = find_approach(path, pose, near, curvature=curvature, limits=LIMITS, room=room)
    track = approach.track
    ends = track.sample(np.array([0.0, track.length]))
    assert ends[0, :2] == pytest.approx((pose.x, pose.y), abs=1e-6)
    assert math.cos(ends[0, 2] - pose.yaw) == pytest.approx(1.0, abs=1e-6)
    np.testing.assert_allclose(ends[1, :3], path.sample(np.array([approach.joins_at]))[0, :3], atol=1e-3)
    beyond = approach.sample(path, track.length + np.array([1.0, 2.0]))
    np.testing.assert_allclose(beyond, path.sample(approach.joins_at + np.array([1.0, 2.0])), atol=1e-9)
    return track.sample(np.linspace(0.0, track.length, 500))


@pytest.mark.parametrize(("offset", "heading"), STARTS)
def test_an_approach_leads_from_the_pose_onto_the_path_within_limits_and_room(offset: float, heading: float) -> None:
    samples = approached(EIGHT, Pose(x=-9.0, y=offset, yaw=heading), near=-9.0, curvature=0.2)
    assert np.abs(samples[:, 3]).max() <= 1.001 * LIMITS.curvature
    assert np.abs(samples[:, 1]).max() <= 5.5
    assert samples[0, 3] == pytest.approx(0.2, abs=0.02)


def test_beside_a_curve_the_turns_end_on_the_curve() -> None:
    near = 20.0
    x, y, yaw, curvature = EIGHT.sample(np.array([near]))[0].tolist()
    assert curvature == pytest.approx(0.125, rel=1e-3)
    pose = Pose(x=x + math.sin(yaw), y=y - math.cos(yaw), yaw=yaw - 1.3)
    samples = approached(EIGHT, pose, near)
    assert np.abs(samples[:, 3]).max() <= 1.5 * LIMITS.curvature


def test_without_room_to_turn_it_says_what_would_help() -> None:
    with pytest.raises(PathError, match=r"faces -?180° away .* within 1 m .*turning_room or vehicle.curvature_limit"):
        approached(EIGHT, Pose(x=0.0, y=0.0, yaw=math.pi), 0.0, room=1.0)
