"""The field's boundary: what is inside, how far ahead it counts, and a drive that stops before it."""

import io
import json
import math
import tracemalloc
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.driving.devices.path_frame import local_frame
from drawbar.driving.loop.driven_line import DrivenLine
from drawbar.driving.loop.field_fence import FieldFence, build_fence
from drawbar.driving.stand_in.rehearsal import Rehearsal
from drawbar.errors import PathError
from drawbar.fields.edge import FieldEdge, load_edge
from drawbar.fields.exchange import read_fields
from drawbar.fields.field import Field, FieldLine
from drawbar.fields.formats import agopengps, geojson
from drawbar.geometry import LocalFrame
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.importers.agopengps import field_lines, wgs84_to_plane
from drawbar.messages import SupervisorState
from drawbar.safety.causes import Cause
from drawbar.simulation import Simulation, build_path

REAL = Path(__file__).parents[4] / "shared" / "data" / "agopengps-field"
FRAME = LocalFrame(latitude=50.87, longitude=4.7)
SEED = 7
EAST = 40.0
"""where the field ends, m"""
STRICT = "path.beyond_boundary=0.0"
SQUARE = np.array([[-20.0, -30.0], [EAST, -30.0], [EAST, 30.0], [-20.0, 30.0]])


def degrees(points):
    latitude, longitude, _ = FRAME.wgs84(points[:, 0], points[:, 1], np.zeros(len(points)))
    return np.column_stack([latitude, longitude])


def box(west, east, south, north):
    return FieldEdge(ring=np.array([[west, south], [east, south], [east, north], [west, north]]))


@pytest.fixture
def field(tmp_path):
    """Return a file with a line to the east through a field, and far beyond it."""
    line = FieldLine(name="east", points=degrees(np.column_stack([np.arange(0.0, 121.0, 5.0), np.zeros(25)])))
    file = tmp_path / "field.geojson"
    file.write_bytes(geojson.write(Field(name="field", lines=(line,), boundary=degrees(SQUARE))))
    return file


def configured(field, *changes):
    given = [f"path.file={field}", "safety.engage.wiggle_test=false", "safety.engage.fixed=1.0", STRICT, *changes]
    return load_configuration("articulated", given)


def angles_sum(ring, point):
    """Return how often a ring winds about a point, by the angles at which its edges are seen."""
    before = ring - point
    after = np.roll(before, -1, axis=0)
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.arctan2(cross, (before * after).sum(axis=1)).sum() / (2.0 * math.pi)


def test_what_is_inside_is_what_the_edge_winds_about():
    chance = np.random.default_rng(SEED)
    bearing = np.sort(chance.uniform(0.0, 2.0 * math.pi, 40))
    ring = chance.uniform(5.0, 50.0, 40)[:, None] * np.column_stack([np.cos(bearing), np.sin(bearing)])
    points = chance.uniform(-50.0, 50.0, (500, 2))
    fence = FieldFence(load_configuration("articulated", [STRICT]), FieldEdge(ring=ring))
    assert fence.contains(points).tolist() == [abs(angles_sum(ring, point)) > 0.5 for point in points]
    assert 50 < fence.contains(points).sum() < 450


def test_a_boundary_of_100000_points_is_looked_at_near_the_vehicle_alone():
    bearing = np.linspace(0.0, 2.0 * math.pi, 100_000, endpoint=False)
    ring = 300.0 * np.column_stack([np.cos(bearing), np.sin(bearing)])
    fence = FieldFence(load_configuration("articulated"), FieldEdge(ring=ring))
    path = figure_eights((10.0,), 960.0)
    tracemalloc.start()
    points = path.sample(np.arange(0.0, path.length, 0.25))[:, :2]
    found = fence.contains(points)
    assert tracemalloc.get_traced_memory()[1] < 100e6
    tracemalloc.stop()
    assert (found == (np.hypot(*points.T) <= 301.0)).all()
    assert 0.01 < found.mean() < 0.99


@pytest.mark.parametrize("beyond", [0.3, 1.0, 5.0])
def test_so_far_beyond_the_edge_is_allowed(beyond):
    fence = FieldFence(load_configuration("articulated", [f"path.beyond_boundary={beyond}"]), FieldEdge(ring=SQUARE))
    near, far = beyond - 0.01, beyond + 0.01
    corner = np.array([EAST, 30.0]) + np.outer([near, far], (0.6, 0.8))
    sides = np.array([[EAST + near, 0.0], [EAST + far, 0.0], [5.0, -30.0 - near], [5.0, -30.0 - far]])
    assert fence.contains(np.vstack([sides, corner])).tolist() == [True, False] * 3


def test_the_width_between_lines_is_not_that_of_the_vehicle():
    fence = FieldFence(load_configuration("articulated", [STRICT, "path.working_width=6.0"]), FieldEdge(ring=SQUARE))
    along = np.array([[x, 29.9] for x in np.arange(-19.0, EAST, 0.5)])
    assert fence.contains(along).all()


def test_the_edge_is_on_the_frame_of_the_line(field):
    configuration = configured(field)
    edge = load_edge(field, local_frame(configuration)).ring
    x, y, yaw, _ = build_path(configuration)[0].sample(np.zeros(1))[0]
    ahead = (edge - (x, y)) @ np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    assert np.abs(ahead - SQUARE).max() < 1e-3


def test_a_hole_is_not_driven_into(step):
    configuration = load_configuration("articulated", ["path.radii=[20.0]", "path.straight_length=120.0"])
    path = build_path(configuration)[0]
    start = path.sample(np.zeros(1))[0, :2]
    pond = start + np.array([[20.0, -2.0], [25.0, -2.0], [25.0, 2.0], [20.0, 2.0]])
    fence = FieldFence(configuration, FieldEdge(ring=SQUARE + start, holes=(pond,)))
    line = DrivenLine.first(configuration, path)
    reached = {s: fence.is_reached(at(step, path, s, speed=1.0), line) for s in (10.0, 17.5, 22.0, 26.0, 29.0)}
    assert reached == {10.0: False, 17.5: True, 22.0: True, 26.0: True, 29.0: False}


@pytest.mark.parametrize("kind", ["geojson", "agopengps"])
def test_holes_are_read_with_the_boundary(field, tmp_path, kind):
    hole = np.array([[10.0, 3.0], [14.0, 3.0], [14.0, 9.0]])
    path = field
    if kind == "geojson":
        document = json.loads(field.read_text("utf-8"))
        area = next(each["geometry"] for each in document["features"] if each["geometry"]["type"] == "Polygon")
        area["coordinates"].append([[east, north] for north, east in degrees(hole).tolist()])
        field.write_text(json.dumps(document), "utf-8")
    else:
        path = tmp_path / "field"
        with zipfile.ZipFile(io.BytesIO(agopengps.write(read_fields(field, FRAME)[0]))) as archive:
            archive.extractall(tmp_path)
        path = next(each.parent for each in tmp_path.rglob("Boundary.txt"))
        latitude, longitude = degrees(hole).T
        east, north = wgs84_to_plane(latitude, longitude, field_lines(path)[0])
        ring = [f"{x:.4f},{y:.4f},0" for x, y in zip(east, north, strict=True)]
        with (path / "Boundary.txt").open("a") as file:
            file.write("\n".join(["True", "3", "0,0,0", "5,0,0", "0,5,0", "False", "3", *ring, ""]))
    edge = load_edge(path, FRAME)
    assert len(edge.holes) == 1
    assert np.abs(edge.holes[0] - hole).max() < 2e-3


def test_a_file_without_a_boundary_has_no_fence(tmp_path):
    (tmp_path / "line.csv").write_text("0,0\n50,0\n", "utf-8")
    assert build_fence(configured(tmp_path / "line.csv")) is None
    assert build_fence(load_configuration("articulated")) is None
    assert build_fence(configured(Path("examples/field").resolve(), "path.track=Cu 14.1°")) is None


def test_a_boundary_that_is_none_is_refused(field):
    document = json.loads(field.read_text("utf-8"))
    area = next(each["geometry"] for each in document["features"] if each["geometry"]["type"] == "Polygon")
    area["coordinates"][0][1] = ["x", 50.87]
    field.write_text(json.dumps(document), "utf-8")
    with pytest.raises(PathError, match="feature 1, position 1"):
        build_fence(configured(field))


@pytest.mark.parametrize(
    ("west", "east", "entry"),
    [(-20.0, 40.0, 0.0), (13.0, 40.0, 13.0), (30.0, 140.0, 30.0), (101.0, 140.0, 101.0), (30.0, 45.0, 0.0)],
)
def test_a_path_comes_in_where_it_stays(field, west, east, entry):
    configuration = configured(field)
    path, _ = build_path(configuration)
    fence = FieldFence(configuration, box(west, east, -9.0, 9.0))
    assert fence.entry(path) == pytest.approx(entry, abs=0.3)


@pytest.mark.skipif(not REAL.is_dir(), reason="the field's recorded data is not here")
def test_recorded_lines_of_agopengps_go_on_beyond_their_field():
    configuration = load_configuration("articulated", [f"path.file={REAL}", "path.track=Cu 49.9°"])
    outside = build_fence(configuration).outside(build_path(configuration)[0])
    assert 130.0 < outside < 170.0


@pytest.fixture(scope="module")
def step():
    """Return a record of a vehicle on a line."""
    return next(iter(Simulation(load_configuration("articulated"), SEED).steps()))


def at(step, path, progress, *, speed=2.0, trailer=None):
    """Return a record of a vehicle on a path at a place, the trailer behind it or at (x, y)."""
    x, y, yaw, _ = path.sample(np.array([progress]))[0].tolist()
    behind = (x - 3.0 * math.cos(yaw), y - 3.0 * math.sin(yaw)) if trailer is None else trailer
    poses = {"tractor": replace(step.estimate.tractor, x=x, y=y, yaw=yaw)}
    poses["trailer"] = replace(step.estimate.trailer, x=behind[0], y=behind[1])
    tractor = replace(step.reference.tractor, progress=progress)
    return replace(
        step,
        estimate=replace(step.estimate, speed=speed, **poses),
        reference=replace(step.reference, tractor=tractor),
    )


@pytest.mark.parametrize(("speed", "way"), [(0.5, 0.7), (1.0, 1.5), (2.0, 3.7), (3.0, 6.6)])
def test_the_boundary_counts_as_far_as_the_front_axle_comes_until_the_vehicle_stands(step, field, speed, way):
    configuration = configured(field, "path.file=", "path.radii=[20.0]", "path.straight_length=120.0")
    path, wheelbase = build_path(configuration)[0], configuration.vehicle.wheelbase
    start = path.sample(np.zeros(1))[0, :2]
    fence = FieldFence(configuration, FieldEdge(ring=SQUARE + start))
    line = DrivenLine.first(configuration, path)
    reached = [fence.is_reached(at(step, path, s, speed=speed), line) for s in np.arange(10.0, EAST, 0.1)]
    first = 10.0 + 0.1 * reached.index(True)
    assert all(reached[reached.index(True) :])
    assert first + wheelbase + way == pytest.approx(EAST, abs=0.11)


def test_a_headland_pass_that_turns_before_the_boundary_is_driven(step):
    configuration = load_configuration("articulated", [STRICT, "speed=2.0", "path.radii=[10.0]"])
    path = figure_eights((10.0,), 20.0)
    points = path.sample(np.arange(0.0, path.length, 0.5))[:, :2]
    (left, low), (right, high) = points.min(axis=0) - 1.0, points.max(axis=0) + 1.0
    fence = FieldFence(configuration, box(left, right, low, high))
    line = DrivenLine.first(configuration, path)
    assert not any(fence.is_reached(at(step, path, s), line) for s in np.arange(4.0, path.length, 1.0))


def test_a_nudge_towards_the_boundary_counts(step):
    configuration = load_configuration("articulated", [STRICT, "path.radii=[20.0]", "path.straight_length=120.0"])
    path = build_path(configuration)[0]
    x, y, yaw, _ = path.sample(np.array([20.0]))[0].tolist()
    assert yaw == pytest.approx(0.0)
    beside = FieldFence(
        configuration,
        box(x - 50.0, x + 50.0, y - 9.0, y + 0.5),
    )
    line = DrivenLine.first(configuration, path)
    assert not beside.is_reached(at(step, path, 20.0), line)
    assert not beside.is_reached(at(step, path, 20.0), line.nudged(-0.6))
    assert beside.is_reached(at(step, path, 20.0), line.nudged(0.6))


def test_the_trailer_may_come_in_behind_the_tractor_but_not_out(step):
    configuration = load_configuration("articulated", [STRICT, "path.radii=[20.0]", "path.straight_length=120.0"])
    path = build_path(configuration)[0]
    start = path.sample(np.zeros(1))[0, :2]
    fence, line = FieldFence(configuration, FieldEdge(ring=SQUARE + start)), DrivenLine.first(configuration, path)
    outside, inside = start + np.array([[-22.0, 0.0], [5.0, 0.0]])
    assert not fence.is_reached(at(step, path, 10.0, trailer=outside), line)
    assert not fence.is_reached(at(step, path, 10.0, trailer=inside), line)
    assert fence.is_reached(at(step, path, 10.0, trailer=outside), line)
    assert fence.is_reached(at(step, path, EAST + 5.0, speed=0.0), line)
    fence.begin()
    assert not fence.is_reached(at(step, path, 10.0, trailer=outside), line)


def driven(rehearsal, path):
    """Return where on the path the tractor is, m."""
    pose = rehearsal.machine.world.truth.tractor
    return float(path.project(pose.x, pose.y, 0.0, path.length)[0])


@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_a_drive_stops_before_the_boundary(field, speed):
    configuration = configured(field, f"speed={speed}")
    path, _ = build_path(configuration)
    rehearsal = Rehearsal(configuration, path, 1, configuration.safety)
    began = False
    while rehearsal.gate_state is None or rehearsal.gate_state.state is not SupervisorState.STOPPED:
        assert rehearsal.time < 90.0
        rehearsal.advance()
        began |= rehearsal.gate_state is not None and rehearsal.gate_state.state is SupervisorState.ACTIVE
    assert began
    assert rehearsal.gate_state.cause == Cause.FIELD_EDGE.value
    assert EAST - 4.0 < driven(rehearsal, path) + configuration.vehicle.wheelbase < EAST


def test_without_the_fence_it_drives_on(field):
    configuration = configured(field, "path.beyond_boundary=100", "speed=2.0")
    path, _ = build_path(configuration)
    rehearsal = Rehearsal(configuration, path, 1, configuration.safety)
    while driven(rehearsal, path) < EAST + 5.0:
        assert rehearsal.time < 90.0
        rehearsal.advance()
    assert rehearsal.gate_state.state is SupervisorState.ACTIVE
