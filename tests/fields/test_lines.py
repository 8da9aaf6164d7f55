"""New lines of a field: on circles and straights, where what is right is known."""

import math

import numpy as np
import pytest

pytest.importorskip("shapely", reason="the extra `console` is not installed")

from drawbar.errors import PathError
from drawbar.fields.field import make_field
from drawbar.fields.lines import from_a_and_b, from_a_and_heading, on_earth, on_plane, pass_beside, with_ends
from drawbar.fields.track import Track
from drawbar.geometry import LocalFrame

TURN = np.linspace(0.0, math.pi, 200)
ARC = 20.0 * np.column_stack([np.cos(TURN), np.sin(TURN)])
"""to the left, around the origin"""
EAST = np.array([[0.0, 0.0], [50.0, 0.0]])
ANCHOR = np.zeros(2)


def test_passes_of_a_straight_line_lie_whole_widths_beside_it() -> None:
    np.testing.assert_allclose(pass_beside(EAST, 3, width=6.0, offset=-0.5), [[0.0, 17.5], [50.0, 17.5]])
    np.testing.assert_allclose(pass_beside(EAST, -1, width=6.0, offset=-0.5), [[0.0, -6.5], [50.0, -6.5]])
    assert pass_beside(EAST, 0, width=6.0, offset=0.0) is EAST


@pytest.mark.parametrize(("number", "radius"), [(1, 14.0), (2, 8.0), (-1, 26.0), (-3, 38.0)])
def test_passes_of_a_circle_are_circles_in_its_direction(number: int, radius: float) -> None:
    found = pass_beside(ARC, number, width=6.0, offset=0.0)
    np.testing.assert_allclose(np.hypot(*found.T), radius, atol=0.02)
    assert found[0, 0] > 0.9 * radius > -0.9 * radius > found[-1, 0]


def test_a_pass_has_no_loop_where_the_curve_is_tighter() -> None:
    corner = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 30.0]])
    inner, outer = (pass_beside(corner, sign, width=5.0, offset=0.0) for sign in (1, -1))
    np.testing.assert_allclose(inner[[0, -1]], [[0.0, 5.0], [25.0, 30.0]], atol=1e-6)
    assert (np.abs(inner - np.array([25.0, 5.0])).min(axis=1) < 1e-6).all()  # two straights and nothing else
    assert np.hypot(*np.diff(outer, axis=0).T).sum() == pytest.approx(60.0 + 2.5 * math.pi, abs=0.01)
    with pytest.raises(PathError, match="nothing is left"):
        pass_beside(np.vstack([ARC, -ARC[1:], ARC[:1]]), 4, width=6.0, offset=0.0)


@pytest.mark.parametrize("number", [1, -1, 3])
def test_no_pass_silently_lacks_half_of_a_line_that_crosses_itself(number: int) -> None:
    turn = np.linspace(0.0, 2.0 * math.pi, 200)
    eight = np.column_stack([60.0 * np.sin(turn), 30.0 * np.sin(2.0 * turn)])
    with pytest.raises(PathError, match="crosses itself"):
        pass_beside(eight, number, width=3.0, offset=0.0)


@pytest.mark.parametrize("number", [1, -1, 3])
def test_a_lap_that_ends_where_it_began_has_passes(number: int) -> None:
    turn = np.linspace(0.0, 2.0 * math.pi, 400)
    found = pass_beside(40.0 * np.column_stack([np.cos(turn), np.sin(turn)]), number, width=3.0, offset=0.0)
    length = np.hypot(*np.diff(found, axis=0).T).sum()
    assert length == pytest.approx(2.0 * math.pi * (40.0 - 3.0 * number), abs=0.2)


@pytest.mark.parametrize("given", [{"width": 0.0}, {"width": math.nan}, {"offset": math.inf}, {"number": 1000}])
def test_nonsense_is_refused(given: dict[str, float]) -> None:
    with pytest.raises(PathError):
        pass_beside(EAST, **{"number": 1, "width": 6.0, "offset": 0.0, **given})


def test_a_and_b_and_a_and_heading() -> None:
    ahead = from_a_and_heading(np.array([5.0, 5.0]), math.radians(90.0))
    np.testing.assert_allclose(ahead, [[5.0, 5.0], [105.0, 5.0]], atol=1e-9)
    np.testing.assert_allclose(from_a_and_b(ANCHOR, np.array([0.0, 3.0])), [[0.0, 0.0], [0.0, 3.0]])
    with pytest.raises(PathError, match="drive on, then set B"):
        from_a_and_b(ANCHOR, np.array([0.0, 0.5]))
    with pytest.raises(PathError, match="degrees from 0"):
        from_a_and_heading(ANCHOR, math.nan)


def test_a_straight_line_ends_at_the_boundary_or_goes_on() -> None:
    ring = np.array([[-7.0, -9.0], [80.0, -9.0], [80.0, 9.0], [-7.0, 9.0]])
    np.testing.assert_allclose(with_ends(EAST, ring, "x"), [[-7.0, 0.0], [80.0, 0.0]])
    np.testing.assert_allclose(with_ends(EAST, None, "x"), [[0.0, 0.0], [150.0, 0.0]])
    assert with_ends(ARC, ring, "x") is ARC
    with pytest.raises(PathError, match="does not cross the field"):
        with_ends(EAST + 50.0, ring, "x")


def test_earth_and_plane_are_each_others_inverse() -> None:
    frame = LocalFrame(latitude=-33.9, longitude=151.0)
    np.testing.assert_allclose(on_plane(on_earth(ARC, frame), frame), ARC, atol=1e-6)


def test_a_track_keeps_few_points_no_standing_and_no_jumps() -> None:
    track = Track()
    for place in [*np.linspace(0.0, 20.0, 401), *[20.0] * 50, 60.0, math.nan, 20.6]:
        track.add(float(place), 0.0)
    line = track.line()
    assert 30 < len(line) <= 42
    assert track.lost == 1
    assert line[-1, 0] == 20.6
    with pytest.raises(PathError, match="drive on"):
        Track().line()


def test_a_track_goes_on_behind_a_gap_without_positions() -> None:
    track = Track()
    for place in [*np.linspace(0.0, 10.0, 51), *np.linspace(18.0, 40.0, 111)]:
        track.add(float(place), 0.0)
    line = track.line()
    assert line[-1, 0] == pytest.approx(40.0, abs=0.6)
    assert np.diff(line[:, 0]).max() == pytest.approx(8.0, abs=0.6)
    assert track.lost == 0


def test_names_of_a_field_are_one_each_and_can_be_files() -> None:
    points = [(50.0, 4.0), (50.1, 4.0)]
    field = make_field("x", "../a\nb", [("l", points), ("l", points), ("", points)], [*points, (50.0, 4.1), points[0]])
    assert [line.name for line in field.lines] == ["l", "l (2)", "line 3"]
    numbered = make_field("x", "x", [("l (2)", points), ("l", points), ("l", points)])
    assert [line.name for line in numbered.lines] == ["l (2)", "l", "l (3)"]
    assert field.name == "a b"
    assert len(field.boundary) == 3
