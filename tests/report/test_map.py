import dataclasses
import math

import numpy as np
import pytest

from drawbar.recording.path_table import PathTable, RecordedPoints
from drawbar.report import style
from drawbar.report.columns import track
from drawbar.report.map import map_figure, outlines, polyline
from drawbar.report.shades import class_shades

VEHICLE_LENGTH = 1.4 + 1.1 + 1.3


def boustrophedon(rows, row_length=1000.0, radius=5.0, step=0.25):
    """Return a long path: rows up and down a field with half circles between them."""
    straight, arc = round(row_length / step), round(math.pi * radius / step)
    turn = math.pi / arc
    turns = np.tile(np.repeat([0.0, turn, 0.0, -turn], [straight, arc, straight, arc]), rows // 2)
    yaw = np.concatenate([[0.0], np.cumsum(turns)])
    moves = step * np.exp(0.5j * (yaw[:-1] + yaw[1:]))
    nodes = np.concatenate([[0.0], np.cumsum(moves)])
    return PathTable(
        arc_length=step * np.arange(len(yaw)),
        x=nodes.real,
        y=nodes.imag,
        yaw=yaw,
        label_of_piece=(turns != 0.0).astype(np.int8),
        label_names=("straight", "curve"),
    )


def distance_to_polyline(points, line):
    """Return how far points (n, 2) are from the closest segment of a line, by looking at all of them."""
    start, along = line[:-1], np.diff(line, axis=0)
    offset = points[:, None] - start
    share = np.clip((offset * along).sum(2) / (along**2).sum(1), 0.0, 1.0)
    return np.linalg.norm(offset - share[..., None] * along, axis=2).min(1)


def with_header(log, **changes):
    return dataclasses.replace(log, header=dataclasses.replace(log.header, **changes))


def traces_of(log):
    return {trace["name"]: trace for trace in map_figure(log)["data"]}


@pytest.mark.parametrize(("steps", "count"), [(1, 1), (30, 1), (45, 2), (90, 3), (None, 12)])
def test_outlines_keep_two_lengths_apart_along_the_track(make_run, steps, count):
    log = make_run(steps=steps)
    tractors, _ = outlines(log)
    shapes = 6  # of one tractor: body, hitch, four wheels
    assert np.isnan(tractors[:, 0]).sum() == shapes * count
    driven = np.hypot(*np.diff(track(log, "tractor"), axis=0).T).sum()
    assert driven >= 2.0 * VEHICLE_LENGTH * (count - 1)
    assert count == 12 or driven < 2.0 * VEHICLE_LENGTH * count


def test_where_the_run_ended_is_always_outlined(make_run):
    for steps in (20, 100):
        log = make_run(steps=steps)
        tractors, _ = outlines(log)
        end = track(log, "tractor")[-1]
        assert np.nanmin(np.hypot(*(tractors - end).T)) < 0.5


def test_a_short_path_is_drawn_by_all_its_nodes(run):
    path = run.header.path
    np.testing.assert_array_equal(polyline(path), np.column_stack([path.x, path.y]))


def test_a_long_path_is_drawn_by_few_vertices_and_keeps_its_turns():
    path = boustrophedon(250)
    drawn = polyline(path)
    assert len(path.x) > 1_000_000
    assert len(drawn) <= 4000
    np.testing.assert_array_equal(drawn[[0, -1]], np.column_stack([path.x, path.y])[[0, -1]])
    some = np.random.default_rng(0).integers(0, len(path.x), 200)  # seed 0
    assert distance_to_polyline(np.column_stack([path.x, path.y])[some], drawn).max() < 0.5


def test_the_recorded_points_and_the_worst_are_marked(run, make_run):
    points = np.array([[0.0, 0.1], [3.0, 0.3], [6.0, 0.2]])
    log = with_header(make_run(steps=5), recorded=RecordedPoints.of(points, np.array([0.1, 0.3, 0.2])))
    traces = traces_of(log)
    np.testing.assert_array_equal(traces["Recorded points"]["y"], [0.1, 0.3, 0.2])
    worst = traces["Furthest from the path"]
    assert (worst["x"].tolist(), worst["y"].tolist()) == ([3.0], [0.3])
    assert "0.30 m" in worst["text"][0]
    assert "Recorded points" not in traces_of(run)


def test_kinks_have_a_colour_of_their_own_on_the_map_and_along_it(make_run):
    log = make_run(steps=5)
    names = ("straight", "curve", "kink", "curve")
    path = dataclasses.replace(log.header.path, label_names=names)
    kink = traces_of(with_header(log, path=path))["Kink"]
    labels = np.array(names)[path.label_of_piece]
    x, y = kink["x"][~np.isnan(kink["x"])], kink["y"][~np.isnan(kink["y"])]
    nodes = np.flatnonzero((np.append(labels, "") == "kink") | (np.insert(labels, 0, "") == "kink"))
    np.testing.assert_allclose(np.sort(x), np.sort(path.x[nodes]), atol=1e-5)
    np.testing.assert_allclose(np.sort(y), np.sort(path.y[nodes]), atol=1e-5)
    shapes = class_shades(path)["shapes"]
    colours = {shape["name"]: shape["fillcolor"] for shape in shapes}
    assert colours["Kink"].startswith(style.KINK)
    assert colours["Curve"] != colours["Kink"]
    assert [shape["name"] for shape in shapes if shape["showlegend"]] == ["Curve", "Kink"]
