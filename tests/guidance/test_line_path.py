"""The C function that makes a path of a recorded line makes that of make_drivable, or refuses."""

import ctypes
from collections.abc import Callable

import numpy as np
import pytest

from drawbar.codegen import build
from drawbar.codegen.library import load
from drawbar.errors import PathError
from drawbar.geometry import Floats
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.importers.line import _LONGEST, _SHORTEST, RecordedLine
from drawbar.guidance.path import PATH_UNIT
from drawbar.guidance.settings import LineLimits
from drawbar.guidance.smoothing import make_drivable

MADE, NULL, POINTS, MEMORY, TIGHT, FAR, UNALIGNED = range(7)
LINE_UNIT = PATH_UNIT + '#include "line_path.h"\n#include "line_table.h"\n'
LIMITS = (0.3, 0.3, 0.3)
"""curvature (1/m), its rate (1/m²), tolerance (m)"""
Outcome = tuple[int, int, Floats]


@pytest.fixture(scope="module")
def line_path() -> Callable[..., Outcome]:
    """Return what the C function returns, its `made`, and the nodes; memory behind the nodes must stay as it was."""
    made = load(build("line", LINE_UNIT)).drawbar_line_path

    def line_path(points: Floats, limits: tuple[float, ...] = LIMITS, capacity: int = 5000) -> Outcome:
        given = np.ascontiguousarray(points, np.float64)
        nodes, work, count = np.full((capacity + 1, 4), 7.0), np.full((capacity + 1, 6), 7.0), ctypes.c_int32(-1)
        status = made(
            given.ctypes.data_as(ctypes.c_void_p),
            len(given),
            np.array(limits).ctypes.data_as(ctypes.c_void_p),
            nodes.ctypes.data_as(ctypes.c_void_p),
            work.ctypes.data_as(ctypes.c_void_p),
            capacity,
            ctypes.byref(count),
        )
        assert (nodes[-1] == 7.0).all()
        assert (work[-1] == 7.0).all()
        return status, count.value, nodes[: count.value]

    return line_path


def driven(seed: int) -> Floats:
    """Return a winding line as a receiver records it, (n, 2) m: uneven distances, 1 cm of noise."""
    rng = np.random.default_rng(seed)
    along = np.cumsum(rng.uniform(0.3, 2.0, 150))
    line = np.column_stack([30.0 * np.cos(along / 30.0), 25.0 * np.sin(along / 25.0) + 2.0 * np.sin(along / 9.0)])
    return line + 0.01 * rng.standard_normal(line.shape)


def in_python(points: Floats, limits: tuple[float, ...] = LIMITS) -> Floats:
    """Return the nodes that drawbar path writes."""
    line = RecordedLine(name="line", x=points[:, 0], y=points[:, 1], frame=None)
    curvature, rate, tolerance = limits
    drivable = make_drivable(line, LineLimits(curvature=curvature, curvature_rate=rate, tolerance=tolerance))
    return drivable.path.nodes


@pytest.mark.parametrize("seed", range(5))
def test_a_line_without_kinks_becomes_the_path_that_drawbar_writes(line_path, seed: int) -> None:
    points = driven(seed)
    status, count, nodes = line_path(points, (0.4, 2.0, 0.3))
    expected = in_python(points, (0.4, 2.0, 0.3))
    assert status == MADE
    assert count == len(expected)
    np.testing.assert_allclose(nodes, expected, rtol=0.0, atol=1e-9)


def test_a_line_of_two_points_is_straight(line_path) -> None:
    points = np.array([[0.0, 0.0], [3.0, 4.0]])
    status, count, nodes = line_path(points)
    assert (status, count) == (MADE, 21)
    np.testing.assert_allclose(nodes, in_python(points), rtol=0.0, atol=1e-9)


def test_a_kink_is_refused_and_the_node_named(line_path) -> None:
    status, node, _ = line_path(np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 20.0]]))
    assert status == TIGHT
    assert abs(node - 80) < 8, "20 m from the start, in steps of 0.25 m"


def test_a_line_that_goes_back_and_forth_near_an_end_is_refused_in_both_languages(line_path) -> None:
    """Smoothed, it has a piece longer than a path may have."""
    there, on = np.arange(0.0, 2.1, 0.5), np.arange(2.0, 50.0, 0.5)
    east = np.concatenate([there, [1.5], on])  # half a metre back
    points = np.column_stack([east, 0.005 * np.sin(7.0 * east)])
    for given in (points, points[::-1]):
        with pytest.raises(PathError, match=r"near .* m it goes back and forth: redraw the line without this turn"):
            in_python(given, (0.3, 0.3, 0.5))
        assert line_path(given, (0.3, 0.3, 0.5))[0] == TIGHT


def test_a_straight_line_that_goes_back_a_little_at_an_end_is_refused_in_both_languages(line_path) -> None:
    """Smoothed, it turns round within its first or last piece, where no curvature shows it."""
    east = np.concatenate([[0.0], np.arange(0.401, -0.1, -0.478), np.arange(0.4, 13.0, 0.5)])
    points = np.column_stack([east, np.zeros(len(east))])
    for given in (points, points[::-1]):
        with pytest.raises(PathError, match=r"near .* m it goes back and forth: redraw the line without this turn"):
            in_python(given, (0.3, 0.3, 0.5))
        assert line_path(given, (0.3, 0.3, 0.5))[0] == TIGHT


def test_a_point_that_the_path_leaves_is_refused_and_named(line_path) -> None:
    points = np.column_stack([np.arange(0.0, 60.0, 0.5), np.zeros(120)])
    points[60, 1] = 0.05
    assert line_path(points, (1.0, 9.0, 0.06))[0] == MADE
    assert line_path(points, (1.0, 9.0, 0.005))[:2] == (FAR, 60)


def test_too_little_memory_is_refused_and_what_is_needed_is_reported(line_path) -> None:
    points = driven(0)
    _, needed, _ = line_path(points, (0.4, 2.0, 0.3))
    assert line_path(points, (0.4, 2.0, 0.3), needed - 1)[:2] == (MEMORY, needed)
    assert line_path(points, (0.4, 2.0, 0.3), needed)[0] == MADE


def test_a_line_is_as_long_as_in_python(line_path) -> None:
    for length, status in ((_SHORTEST - 1e-9, POINTS), (_SHORTEST, MADE), (_LONGEST + 0.1, POINTS)):
        assert line_path(np.array([[0.0, 0.0], [length, 0.0]]), capacity=100)[0] == status
    assert line_path(np.array([[0.0, 0.0], [_LONGEST, 0.0]]))[0] == MEMORY


@pytest.mark.parametrize("wrong", [np.nan, np.inf, 2e7])
def test_points_that_are_none_are_refused(line_path, wrong: float) -> None:
    points = driven(0)
    points[7, 1] = wrong
    assert line_path(points)[0] == POINTS
    assert line_path(driven(0)[:1])[0] == POINTS
    assert line_path(np.zeros((3, 2)))[0] == POINTS
    assert line_path(driven(0), (0.3, 0.0, 0.3))[0] == POINTS


def nearest(
    path: Floats, place: tuple[float, float, float], reach: float = 5.0, both_ways: int = 0
) -> tuple[int, float, int]:
    """Return what the C function returns, and what it found."""
    found, against = ctypes.c_double(-1.0), ctypes.c_int32(-1)
    function = load(build("line", LINE_UNIT)).drawbar_line_nearest
    function.argtypes = [
        ctypes.c_void_p,
        ctypes.c_int32,
        *[ctypes.c_double] * 4,
        ctypes.c_int32,
        *[ctypes.c_void_p] * 2,
    ]
    results = ctypes.addressof(found), ctypes.addressof(against)
    status = function(path.ctypes.data, len(path), *place, reach, both_ways, *results)
    return status, found.value, against.value


def test_the_nearest_place_and_the_way_round_are_those_of_python() -> None:
    reverse = load(build("line", LINE_UNIT)).drawbar_line_reverse
    path, rng = figure_eights((8.0,), 20.0), np.random.default_rng(8)  # seed 8
    for _ in range(100):
        x, y, yaw = (float(each) for each in rng.uniform([-15.0, -15.0, -3.0], [35.0, 15.0, 3.0]))
        expected = path.nearest(x, y, yaw, reach=5.0, both_ways=True)
        assert nearest(path.nodes, (x, y, yaw), both_ways=1) == (MADE, *expected)
    turned = np.full(path.nodes.shape, 7.0)
    assert reverse(ctypes.c_void_p(path.nodes.ctypes.data), len(turned), ctypes.c_void_p(turned.ctypes.data)) == MADE
    np.testing.assert_array_equal(turned, path.reversed().nodes)


@pytest.mark.parametrize("place", [(np.nan, 0.0, 0.0), (0.0, np.inf, 0.0), (0.0, 0.0, np.inf), (1e8, 0.0, 0.0)])
def test_a_place_that_is_none_is_refused(place: tuple[float, float, float]) -> None:
    nodes = figure_eights((8.0,), 20.0).nodes
    assert nearest(nodes, place) == (POINTS, -1.0, -1)


def test_a_reach_or_a_path_that_is_none_is_refused() -> None:
    nodes = figure_eights((8.0,), 20.0).nodes
    assert [nearest(nodes, (0.0, 0.0, 0.0), reach)[0] for reach in (0.0, np.nan, -1.0)] == [POINTS] * 3
    assert nearest(nodes[:1], (0.0, 0.0, 0.0))[0] == POINTS
    broken = nodes.copy()
    broken[5, 1] += 1.0
    assert nearest(broken, (0.0, 0.0, 0.0))[0] == POINTS


NUMBERS, COUNT = 4, 2
"""bytes by which a pointer to such is moved"""


@pytest.mark.parametrize(
    ("name", "takes"),
    [
        ("path", (NUMBERS, ctypes.c_int32(2), NUMBERS, NUMBERS, NUMBERS, ctypes.c_int32(100), COUNT)),
        (
            "nearest",
            (NUMBERS, ctypes.c_int32(2), *[ctypes.c_double(1.0)] * 4, ctypes.c_int32(0), NUMBERS, COUNT),
        ),
        ("reverse", (NUMBERS, ctypes.c_int32(2), NUMBERS)),
    ],
)
def test_pointers_that_are_null_or_not_aligned_are_refused_and_nothing_is_written(
    name: str, takes: tuple[object, ...]
) -> None:
    function = load(build("line", LINE_UNIT))[f"drawbar_line_{name}"]
    room = np.full(2000, 7.0)
    good = [ctypes.c_void_p(room.ctypes.data) if isinstance(each, int) else each for each in takes]
    for place, moved in enumerate(takes):
        if isinstance(moved, int):
            for wrong, status in ((None, NULL), (room.ctypes.data + moved, UNALIGNED)):
                assert function(*good[:place], ctypes.c_void_p(wrong), *good[place + 1 :]) == status, (place, wrong)
    assert (room == 7.0).all()
