"""Lines beside a path, and how a vehicle gets from one to the next."""

import ctypes
import math
from collections.abc import Sequence
from itertools import islice

import numpy as np
import pytest

from drawbar.codegen import build
from drawbar.codegen.library import load
from drawbar.config import load_configuration
from drawbar.errors import DrawbarError
from drawbar.geometry import Floats
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.path import PATH_UNIT, CPath, Path
from drawbar.simulation import Simulation, build_path

SOURCE = """
static struct line_offset offset;
static struct path line;
void begin(const struct path *path, double wanted)
{
    const struct line_offset none = {0};
    line = *path;
    line.offset = &offset;
    offset = none;
    offset.wanted = wanted;
    offset_begin(&offset);
}
void wish(double wanted) { offset.wanted = wanted; }
void advance(double foremost, double hindmost) { offset_advance(&offset, 0.03, 0.03, foremost, hindmost); }
void sample(double arc_length, double *sample) { drawbar_path_sample(&line, arc_length, sample); }
double project(double x, double y, double near, double *error)
{
    return drawbar_path_project(&line, x, y, near - 1.0, near + 1.0, error);
}
double ahead(double arc_length, double distance) { return path_ahead(&line, arc_length, distance); }
int has_beside(const struct path *path, double wanted) { return path_has_beside(path, wanted, 0.3); }
"""
EIGHT = figure_eights((8.0,), 20.0)
Real, Array = ctypes.c_double, ctypes.c_double * 4


class Line:
    """A line beside a path in C."""

    def __init__(self, path: Path, offset: float) -> None:
        self._c = load(build("line_offset", PATH_UNIT + SOURCE))
        for name in ("project", "ahead"):
            getattr(self._c, name).restype = Real
        self._path = CPath(path.nodes)
        self._c.begin(ctypes.byref(self._path), Real(offset))

    def wish(self, offset: float) -> None:
        self._c.wish(Real(offset))

    def advance(self, foremost: float, hindmost: float) -> None:
        self._c.advance(Real(foremost), Real(hindmost))

    def sample(self, places: Sequence[float] | Floats) -> Floats:
        samples = []
        for place in places:
            array = Array()
            self._c.sample(Real(place), array)
            samples.append(list(array))
        return np.array(samples)

    def project(self, x: float, y: float, near: float) -> tuple[float, float]:
        error = Real()
        return self._c.project(Real(x), Real(y), Real(near), ctypes.byref(error)), error.value

    def ahead(self, arc_length: float, distance: float) -> float:
        return float(self._c.ahead(Real(arc_length), Real(distance)))

    def has_beside(self, offset: float) -> bool:
        return bool(self._c.has_beside(ctypes.byref(self._path), Real(offset)))


def test_without_an_offset_the_line_is_the_path() -> None:
    """Bit for bit, but for directions: a compiler may contract the arctangent in lanes otherwise than a single one."""
    places = np.arange(-2.0, EIGHT.length + 2.0, 0.37)
    line = Line(EIGHT, 0.0)
    along, path = line.sample(places), EIGHT.sample(places)
    np.testing.assert_array_equal(along[:, [0, 1, 3]], path[:, [0, 1, 3]])
    np.testing.assert_allclose(along[:, 2], path[:, 2], rtol=0.0, atol=1e-15)
    assert line.ahead(3.7, 0.2) == 3.7 + 0.2
    for place in places[::20]:
        x, y, _, _ = EIGHT.sample(np.array(place)).tolist()
        assert line.project(x + 0.1, y, place) == EIGHT.project(x + 0.1, y, place - 1.0, place + 1.0)


@pytest.mark.parametrize("offset", [-2.0, 0.4, 3.0])
def test_a_steady_offset_is_the_parallel_line_of_python(offset: float) -> None:
    line, beside = Line(EIGHT, offset), EIGHT.beside(offset)
    places = np.arange(0.0, EIGHT.length, 0.25)
    samples = line.sample(places)
    for place, sample in zip(places, samples, strict=True):
        x, y, yaw, curvature = sample.tolist()
        near = place - offset * (yaw - samples[0, 2])
        found, error = beside.project(x, y, near - 1.0, near + 1.0)
        expected = beside.sample(np.array(found)).tolist()
        assert error == pytest.approx(0.0, abs=1e-6)
        assert yaw == pytest.approx(expected[2], abs=1e-5)
        if np.ptp(EIGHT.sample(np.array([place - 0.3, place + 0.3]))[:, 3]) < 1e-4:
            assert curvature == pytest.approx(expected[3], abs=2e-4)


def test_a_shift_has_the_direction_and_curvature_of_its_own_points() -> None:
    line, step = Line(EIGHT, 0.0), 1e-3
    line.wish(0.5)
    line.advance(4.0, 1.5)  # on the straight, on into the curve
    places = np.arange(3.0, 18.0, 0.05)
    places = places[np.abs(EIGHT.sample(places)[:, 3] - EIGHT.sample(places + 0.3)[:, 3]) < 1e-6]
    before, here, after = (line.sample(places + by) for by in (-step, 0.0, step))
    way = np.hypot(*(after - before)[:, :2].T)
    np.testing.assert_allclose((after - before)[:, 0] / way, np.cos(here[:, 2]), atol=1e-5)
    np.testing.assert_allclose((after - before)[:, 1] / way, np.sin(here[:, 2]), atol=1e-5)
    np.testing.assert_allclose((after - before)[:, 2] / way, here[:, 3], atol=1e-4)


@pytest.mark.parametrize("change", [0.02, 0.3, -3.0])
def test_a_shift_keeps_its_limits(change: float) -> None:
    line = Line(EIGHT, 0.1)
    line.wish(0.1 + change)
    line.advance(-30.0, -33.0)  # on the straight before the path
    curvature = line.sample(np.arange(-31.0, 0.0, 0.01))[:, 3]
    largest, fastest = np.abs(curvature).max(), np.abs(np.diff(curvature)).max() / 0.01
    assert largest <= 0.0301
    assert fastest <= 0.0301
    assert max(largest, fastest) > 0.029  # and it is no longer than it must be


def test_wishes_wait_for_each_other_and_none_jumps() -> None:
    line, rng = Line(EIGHT, 0.0), np.random.default_rng(3)  # seed 3
    front, back, wanted = 0.0, -2.5, 0.0
    for _ in range(400):
        if rng.random() < 0.2:
            wanted = float(rng.uniform(-1.0, 1.0))
            line.wish(wanted)
        line.advance(front, back)
        behind = line.sample([front - 2.5, front - 0.01])[:, 1]
        line.advance(front, back)
        assert line.sample([front - 2.5, front - 0.01])[:, 1] == pytest.approx(behind, abs=1e-12)
        front, back = front + 0.1, back + 0.1
    for _ in range(400):
        line.advance(front, back)
        front, back = front + 0.1, back + 0.1
    x, y, yaw, _ = EIGHT.sample(np.array(front)).tolist()
    there = line.sample([front])[0]
    assert -math.sin(yaw) * (there[0] - x) + math.cos(yaw) * (there[1] - y) == pytest.approx(wanted, abs=1e-9)


def test_the_way_along_the_line_is_measured_on_the_line() -> None:
    line = Line(EIGHT, 3.0)
    place, total, here = 30.0, 0.0, line.sample([30.0])[0]
    for _ in range(100):
        place = line.ahead(place, 0.02)
        there = line.sample([place])[0]
        total, here = total + math.hypot(*(there - here)[:2]), there
    assert total == pytest.approx(2.0, rel=1e-3)


def test_a_line_that_a_curve_leaves_no_room_for_is_refused() -> None:
    line = Line(EIGHT, 0.0)  # both ways round, 8 m
    assert line.has_beside(4.6)
    assert line.has_beside(-4.6)
    assert not line.has_beside(4.8)  # 3.2 m: tighter than 0.3 1/m
    assert not line.has_beside(-4.8)
    assert not line.has_beside(9.0)  # beyond the centre
    tight = Line(figure_eights((3.0,), 20.0), 0.0)
    assert tight.has_beside(0.0)
    assert not tight.has_beside(0.01)


def nudged(offset: float) -> tuple[Floats, Floats, Floats]:
    """Return lateral places of both bodies (m), their errors as estimated (m) and commands (rad) on a straight."""
    changes = ["path.radii=[8.0]", "path.straight_length=100.0"]
    with Simulation(load_configuration("articulated", changes)) as simulation:
        places, errors, commands = [], [], []
        for record in islice(simulation.steps(), 140):
            assert record.truth is not None
            places.append((record.truth.tractor.y, record.truth.trailer.y))
            errors.append((record.reference.tractor.lateral_error, record.reference.trailer.lateral_error))
            commands.append((record.command.tractor_steering, record.command.trailer_steering))
            if record.step == 40:
                simulation.autopilot.set_offset(offset)
    return np.array(places), np.array(errors), np.array(commands)


def test_a_nudge_in_a_run_is_followed_softly() -> None:
    places, errors, commands = nudged(0.3)
    _, _, straight_on = nudged(0.0)
    np.testing.assert_allclose(places[20:40].mean(0), 0.0, atol=0.03)
    np.testing.assert_allclose(places[110:].mean(0), 0.3, atol=0.03)
    assert np.abs(errors[20:]).max() < 0.06
    bump = np.abs(np.diff(commands - straight_on, axis=0)).max(0)
    assert (bump < np.radians([2.0, 3.5])).all(), np.degrees(bump)


def test_an_offset_that_cannot_be_is_reported() -> None:
    with Simulation(load_configuration("articulated", ["path.radii=[8.0]"])) as simulation:
        for wrong in (200.0, 7.5):
            with pytest.raises(DrawbarError, match=rf"offset = {wrong} m is not allowed; give at most 100 m"):
                simulation.autopilot.set_offset(wrong)
        with pytest.raises(DrawbarError, match="offset"):
            simulation.autopilot.set_offset(math.nan)


def test_a_configured_offset_is_driven_and_judged_beside_the_line() -> None:
    configuration = load_configuration("articulated", ["path.radii=[8.0]", "path.offset=1.2"])
    path, _ = build_path(configuration)
    np.testing.assert_array_equal(path.nodes, EIGHT.beside(1.2).nodes)
