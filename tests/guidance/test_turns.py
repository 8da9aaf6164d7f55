"""Turns against a straightforward integration, and the ways onto a line and onto a path that they make up."""

import ctypes
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drawbar.codegen import build
from drawbar.codegen.library import load
from drawbar.geometry import Floats
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.path import PATH_UNIT, CPath, Path
from drawbar.signals import Pose

CURVATURE, RATE = 0.3, 0.25
EIGHT = figure_eights((8.0,), 20.0)
STRAIGHT = figure_eights((8.0,), 400.0)
ANGLES = (0.02, 0.3, 1.0, math.pi, 5.0)
STARTS = [(0.0, math.pi), (0.0, -2.5), (1.5, 2.0), (-1.0, -2.4), (0.0, 1.5), (2.0, 0.0)]
NODES = 240
SOURCE = """
#include "approach.h"
void turn(const struct turn_limits *limits, double angle, double found[3])
{
    found[0] = turn_peak(limits, angle);
    found[1] = turn_length(limits, angle);
    const struct turn_circle circle = turn_circle(limits);
    found[2] = turn_chord(limits, &circle, angle);
}
int trace(const struct turn_limits *limits, const double *angles, int turns, double heading, double curvature,
          struct drawbar_path_node *nodes, int32_t capacity)
{
    const struct curve curve = curve_of_turns(limits, angles, turns, curvature);
    return curve_trace(&curve, 0.0, 0.0, heading, nodes, capacity);
}
int onto_line(const struct turn_limits *limits, double offset, double heading, double room, double (*angles)[TURNS])
{
    struct onto_line line;
    struct candidate candidate;
    int count = 0;

    for (line_candidates(&line, limits, offset, heading, room); line_take(&line, LINE_CANDIDATES, &candidate); ++count)
        candidate_angles(&line, &candidate, angles[count]);
    return count;
}
int find(const struct turn_limits *limits, const struct path *path, const struct drawbar_pose *pose, double near,
         double curvature, double room, struct approach *approach)
{
    const struct beside_path beside = beside_path(path, pose, near, curvature);
    struct onto_line line;
    return approach_find(approach, path, &beside, limits, room, &line);
}
double shortest(const struct turn_limits *limits, const struct path *path, const struct drawbar_pose *pose, double near,
                double room, struct approach *approach)
{
    const struct beside_path beside = beside_path(path, pose, near, 0.0);
    struct onto_line line;
    struct candidate candidate;
    double angles[TURNS];

    line_candidates(&line, limits, beside.offset, beside.heading, room);
    while (line_take(&line, LINE_CANDIDATES, &candidate)) {
        candidate_angles(&line, &candidate, angles);
        approach_trace(approach, &beside, limits, angles, TURNS, APPROACH_NODES);
        if (approach_widest(approach) <= room && approach_lay(approach, path, APPROACH_TIGHTER * limits->curvature))
            return approach->nodes[approach->count - 1].arc_length;
    }
    return INFINITY;
}
double laid_bend(const struct path *path, double near, double left, double direction, double bend)
{
    double sample[4];

    drawbar_path_sample(path, near, sample);
    return approach_bend(sample, left, approach_unit(direction), bend);
}
void sample(const struct approach *approach, const struct path *path, double arc_length, double *sample)
{
    approach_sample(approach, path, arc_length, sample);
}
"""
Real = ctypes.c_double


class Approach(ctypes.Structure):
    """struct approach."""

    _fields_ = (
        ("nodes", Real * 4 * NODES),
        ("count", ctypes.c_int32),
        ("joins_at", Real),
    )

    def sample(self, path: Path, arc_length: Floats) -> Floats:
        samples = np.zeros((len(arc_length), 4))
        for distance, row in zip(arc_length.tolist(), samples, strict=True):
            C.sample(
                ctypes.byref(self), ctypes.byref(CPath(path.nodes)), Real(distance), ctypes.c_void_p(row.ctypes.data)
            )
        return samples

    @property
    def length(self) -> float:
        return self.nodes[self.count - 1][0]


C = load(build("turns", PATH_UNIT + SOURCE))
C.shortest.restype = C.laid_bend.restype = Real
LIMITS = (Real * 2)(CURVATURE, RATE)


def turn(angle: float) -> tuple[float, float, float]:
    """Return largest curvature, length and chord of a turn."""
    found = (Real * 3)()
    C.turn(LIMITS, Real(angle), found)
    return tuple(found)


def trace(*angles: float, heading: float = 0.0, curvature: float = 0.0, capacity: int = NODES) -> Floats:
    """Return (n, 4): arc length, x, y, heading of the nodes of turns from the origin."""
    nodes = (Real * 4 * NODES)()
    turns = (Real * len(angles))(*angles)
    count = C.trace(LIMITS, turns, len(angles), Real(heading), Real(curvature), nodes, capacity)
    return np.array(nodes)[:count]


def turns_onto_line(offset: float, heading: float, room: float = math.inf) -> Floats:
    """Return (n, 3): angles of three turns that lead onto a line, the shortest ways first."""
    angles = (Real * 3 * NODES)()
    count = C.onto_line(LIMITS, Real(offset), Real(heading), Real(room), angles)
    return np.array(angles)[:count]


def find_approach(path: Path, pose: Pose, near: float, curvature: float, room: float) -> Approach | None:
    """Return the way onto the path, None where there is none."""
    approach = Approach()
    there = (Real * 3)(pose.x, pose.y, pose.yaw)
    reals = (Real(near), Real(curvature), Real(room))
    return approach if C.find(LIMITS, ctypes.byref(CPath(path.nodes)), there, *reals, ctypes.byref(approach)) else None


def driven(angle: float) -> tuple[complex, float, float]:
    """Return end point, length and largest curvature of one turn to the left, integrated from its definition."""
    peak = min(CURVATURE, math.sqrt(RATE * angle))
    length = angle / peak + peak / RATE

    def rates(s, state):
        curvature = min(RATE * s, peak, RATE * (length - s))
        return [math.cos(state[2]), math.sin(state[2]), curvature]

    end = solve_ivp(rates, (0.0, length), [0.0, 0.0, 0.0], rtol=1e-10, atol=1e-12, max_step=0.05).y[:, -1]
    assert end[2] == pytest.approx(angle, abs=1e-6)
    return complex(end[0], end[1]), length, peak


@pytest.mark.parametrize("angle", ANGLES)
def test_chord_length_and_peak_are_those_of_the_curve(angle: float) -> None:
    end, length, peak = driven(angle)
    for signed in (angle, -angle):
        assert turn(signed)[:2] == pytest.approx((peak, length))
        assert turn(signed)[2] * np.exp(0.5j * angle) == pytest.approx(end, abs=1e-6)


@pytest.mark.parametrize("angle", ANGLES)
def test_trace_is_the_curve(angle: float) -> None:
    end, _, _ = driven(angle)
    left = trace(angle)
    assert complex(*left[-1, 1:3]) == pytest.approx(end, abs=1e-5)
    assert left[-1, 3] == pytest.approx(angle)
    assert np.diff(left[:, 0]).max() <= 0.25 + 1e-5
    right = trace(-angle, heading=0.7)
    points = np.exp(0.7j) * (left[:, 1] - 1j * left[:, 2])
    np.testing.assert_allclose(right[:, 1] + 1j * right[:, 2], points, atol=1e-12)


def test_wheels_that_are_turned_are_brought_straight_first() -> None:
    assert trace(curvature=-0.3)[-1, 3] == pytest.approx(-0.5 * 0.3**2 / RATE)


def test_a_curve_that_is_too_long_is_none() -> None:
    count = len(trace(5.0, -5.0))
    assert len(trace(5.0, -5.0, capacity=count)) == count
    assert len(trace(5.0, -5.0, capacity=count - 1)) == 0
    assert len(trace(5.0, curvature=1e300)) == 0


@pytest.mark.parametrize(("offset", "heading"), STARTS)
def test_turns_end_on_the_line_in_its_direction(offset: float, heading: float) -> None:
    found = turns_onto_line(offset, heading)
    lengths = [sum(turn(angle)[1] for angle in angles) for angles in found.tolist()]
    assert (np.diff(lengths) >= -1e-8).all()
    for angles in found[:5].tolist():
        end = trace(*angles, heading=heading)[-1]
        assert offset + end[2] == pytest.approx(0.0, abs=1e-4)
        assert math.cos(end[3]) == pytest.approx(1.0)


@pytest.mark.parametrize(("offset", "heading"), STARTS)
def test_ways_whose_turns_end_outside_the_room_are_left_out(offset: float, heading: float) -> None:
    everywhere, room = turns_onto_line(offset, heading), 3.0
    ends = [[trace(*angles[:k], heading=heading)[-1, 2] for k in (1, 2)] for angles in everywhere.tolist()]
    within = np.abs(offset + np.array(ends)).max(axis=1) <= room
    assert 0 < within.sum() < len(within)
    np.testing.assert_allclose(turns_onto_line(offset, heading, room), everywhere[within], atol=1e-12)


def test_the_mirrored_start_takes_the_mirrored_turns() -> None:
    here, there = turns_onto_line(1.5, 2.0), turns_onto_line(-1.5, -2.0)
    np.testing.assert_allclose(there[0], -here[0], atol=1e-9)


def approached(path: Path, pose: Pose, near: float, curvature: float = 0.0, room: float = 5.5) -> Floats:
    approach = find_approach(path, pose, near, curvature, room)
    ends = approach.sample(path, np.array([0.0, approach.length]))
    assert ends[0, :2] == pytest.approx((pose.x, pose.y), abs=1e-6)
    assert math.cos(ends[0, 2] - pose.yaw) == pytest.approx(1.0, abs=1e-6)
    np.testing.assert_allclose(ends[1, :3], path.sample(np.array([approach.joins_at]))[0, :3], atol=1e-3)
    beyond = approach.sample(path, approach.length + np.array([1.0, 2.0]))
    np.testing.assert_allclose(beyond, path.sample(approach.joins_at + np.array([1.0, 2.0])), atol=1e-9)
    return approach.sample(path, np.linspace(0.0, approach.length, 500))


@pytest.mark.parametrize(("offset", "heading"), STARTS)
def test_an_approach_leads_from_the_pose_onto_the_path_within_limits_and_room(offset: float, heading: float) -> None:
    samples = approached(EIGHT, Pose(x=-9.0, y=offset, yaw=heading), near=-9.0, curvature=0.2)
    assert np.abs(samples[:, 3]).max() <= 1.001 * CURVATURE
    assert np.abs(samples[:, 1]).max() <= 5.5
    assert samples[0, 3] == pytest.approx(0.2, abs=0.02)


def test_beside_a_curve_the_turns_end_on_the_curve() -> None:
    near = 20.0
    x, y, yaw, curvature = EIGHT.sample(np.array([near]))[0].tolist()
    assert curvature == pytest.approx(0.125, rel=1e-3)
    pose = Pose(x=x + math.sin(yaw), y=y - math.cos(yaw), yaw=yaw - 1.3)
    samples = approached(EIGHT, pose, near)
    assert np.abs(samples[:, 3]).max() <= 1.5 * CURVATURE


@pytest.mark.parametrize("turned", [-3.0, -1.3, 1.3, 2.2, 3.0])
def test_beside_a_curve_no_way_is_much_tighter_than_its_limit(turned: float) -> None:
    near = 20.0
    x, y, yaw, _ = EIGHT.sample(np.array([near]))[0].tolist()
    approach = find_approach(EIGHT, Pose(x=x, y=y, yaw=yaw + turned), near, 0.0, room=50.0)
    if approach is not None:
        curvatures = approach.sample(EIGHT, np.linspace(0.0, approach.length, 500))[:, 3]
        assert np.abs(curvatures).max() <= 1.5 * CURVATURE


def test_without_room_to_turn_there_is_no_way() -> None:
    assert find_approach(EIGHT, Pose(x=0.0, y=0.0, yaw=math.pi), 0.0, 0.0, room=1.0) is None


@pytest.mark.parametrize("curvature", [math.nan, math.inf, 1e300, -1e300])
def test_wheels_that_stand_nowhere_have_no_way(curvature: float) -> None:
    assert find_approach(EIGHT, Pose(x=0.0, y=0.0, yaw=math.pi), 0.0, curvature, room=5.5) is None


def test_no_way_is_left_out_for_how_it_looks_before_it_is_laid() -> None:
    path, rng = ctypes.byref(CPath(EIGHT.nodes)), np.random.default_rng(12)
    found = 0
    for near, left, turned in rng.uniform((-12.0, -2.0, 1.2), (60.0, 2.0, 5.0), (60, 3)).tolist():
        x, y, yaw, _ = EIGHT.sample(np.array([near]))[0].tolist()
        pose = Pose(x=x - left * math.sin(yaw), y=y + left * math.cos(yaw), yaw=yaw + turned)
        there, room = (Real * 3)(pose.x, pose.y, pose.yaw), 5.0
        shortest = C.shortest(LIMITS, path, there, Real(near), Real(room), ctypes.byref(Approach()))
        approach = find_approach(EIGHT, pose, near, 0.0, room)
        assert approach is None or approach.length == pytest.approx(shortest)
        found += approach is not None
    assert found > 20


@pytest.mark.parametrize("direction", [0.0, 0.7, 2.0, math.pi, -2.5])
@pytest.mark.parametrize("left", [-3.0, 1.0, 2.5])
def test_a_curve_laid_beside_a_curve_is_as_tight_as_said(left: float, direction: float) -> None:
    near, bend, radius = 20.0, 0.2, 8.0  # in the middle of an arc to the left
    step = 1e-3 * np.arange(-1, 2)
    line = near + 1j * left + np.exp(1j * direction) * (step + 0.5j * bend * step**2)
    laid = (radius - line.imag) * np.exp(1j * line.real / radius)
    first, second = (laid[2] - laid[0]) / 2e-3, (laid[2] - 2.0 * laid[1] + laid[0]) / 1e-6
    expected = (first.conjugate() * second).imag / abs(first) ** 3
    path, given = ctypes.byref(CPath(EIGHT.nodes)), (Real(near), Real(left), Real(direction), Real(bend))
    assert C.laid_bend(path, *given) == pytest.approx(expected, abs=2e-3)


class Guarded(ctypes.Structure):
    """An approach behind a node that is not its own."""

    _fields_ = (("before", Real * 4), ("approach", Approach))


def test_where_every_way_is_too_long_there_is_none() -> None:
    wide, there = (Real * 2)(0.05, 0.02), (Real * 3)(0.0, 1.0, 3.0)
    guarded = Guarded((Real * 4)(*[7.0] * 4))
    place = ctypes.byref(guarded, Guarded.approach.offset)
    reals = (Real(0.0), Real(0.0), Real(200.0))
    assert C.find(wide, ctypes.byref(CPath(STRAIGHT.nodes)), there, *reals, place) == 0
    assert guarded.approach.count == 0
    assert guarded.approach.joins_at != 7.0
