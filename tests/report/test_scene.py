"""The run in space: where it is shown, that it stands on the ground, and that a page stays light."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
import pytest
from chromium import LONGEST, open_chromium

from drawbar.config import load_configuration
from drawbar.geometry import arm_offset
from drawbar.recording.log import RunLog
from drawbar.report.metrics import compute_metrics
from drawbar.report.page import render_page
from drawbar.report.path_errors import true_path_errors
from drawbar.report.scene import scene_figure
from drawbar.report.solids import mast_solid, rotation, tool_solid, tractor_solid, trailer_solid
from drawbar.simulation import simulate
from drawbar.vehicle.parameters import VehicleParameters

FIELD = ["path.radii=[8.0]", "vehicle.masts={tractor={up=2.5},trailer={up=2.0}}"]
SLOPE = ["machine.terrain={slope=0.1,unevenness=0.02}"]


@pytest.fixture(scope="module")
def log() -> RunLog:
    return simulate(load_configuration("articulated", [*FIELD, *SLOPE]))


def test_rotation_is_that_of_lever_arms() -> None:
    arm = (0.6, -0.2, 2.5)
    for yaw, roll, pitch in ((0.3, 0.1, -0.05), (-2.0, -0.2, 0.1), (3.0, 0.0, 0.2)):
        east, north, _ = (rotation(yaw, roll, pitch) @ arm).tolist()
        assert (east, north) == pytest.approx(arm_offset(yaw, roll, pitch, arm), abs=1e-12)


def test_wheels_touch_the_ground_and_triangles_have_corners() -> None:
    vehicle = VehicleParameters()
    for solid in (tractor_solid(vehicle, 0.2), trailer_solid(vehicle)):
        assert solid.corners[:, 2].min() == pytest.approx(0.0, abs=1e-12)
        assert (solid.triangles.min(), solid.triangles.max()) == (0, len(solid.corners) - 1)
    assert mast_solid((0.1, 0.2, 2.5)).corners.max(axis=0)[2] == pytest.approx(2.54)


def test_a_tool_reaches_from_the_ground_to_its_beam_from_its_bodys_point() -> None:
    forward, left = -0.6, 0.2
    corners = tool_solid((forward, left)).corners
    assert (corners[:, 2].min(), corners[:, 2].max()) == pytest.approx((0.0, 0.35))
    assert corners[8:].mean(axis=0) == pytest.approx((forward, left, 0.15))
    assert corners[:8].mean(axis=0) == pytest.approx((0.5 * forward, 0.5 * left, 0.3))


def test_a_tool_is_drawn_on_each_body_that_has_one(log: RunLog) -> None:
    tracked = load_configuration("articulated", [*FIELD, *SLOPE, "vehicle.tracked.trailer.forward=-0.6"]).to_toml()
    fitted = dataclasses.replace(log, header=dataclasses.replace(log.header, configuration=tracked))
    bodies = [
        {trace["name"]: len(trace["x"]) for trace in scene_figure(each)["data"] if trace["type"] == "mesh3d"}
        for each in (log, fitted)
    ]
    assert bodies[1]["Tractor"] == bodies[0]["Tractor"]
    assert bodies[1]["Trailer"] > bodies[0]["Trailer"]


def test_scene_is_drawn_where_the_ground_is_not_flat(log: RunLog) -> None:
    figure = scene_figure(log)
    traces = {(trace["type"], trace["name"]): trace for trace in figure["data"]}
    assert set(traces) == {
        ("surface", "Ground"),
        ("scatter3d", "Path"),
        ("scatter3d", "Tractor"),
        ("scatter3d", "Antenna of the tractor"),
        ("scatter3d", "Trailer"),
        ("scatter3d", "Antenna of the trailer"),
        ("mesh3d", "Tractor"),
        ("mesh3d", "Trailer"),
    }
    track = traces["scatter3d", "Tractor"]
    assert track["z"] == pytest.approx(math.tan(0.1) * track["y"], abs=0.2)  # it falls to the south
    lifted = traces["scatter3d", "Antenna of the tractor"]["z"] - track["z"]
    assert np.abs(lifted - 2.5 * math.cos(0.1)).max() < 0.1
    assert go.Figure(figure)  # plotly knows every key


def test_scene_is_light(log: RunLog) -> None:
    assert len(json.dumps(json.loads(go.Figure(scene_figure(log)).to_json()))) < 1_000_000


def test_there_is_no_scene_without_truth_or_slope(log: RunLog) -> None:
    blind = tuple(dataclasses.replace(record, truth=None) for record in log.records)
    assert scene_figure(dataclasses.replace(log, records=blind))["data"] == []
    flat = load_configuration("articulated", FIELD).to_toml()
    header = dataclasses.replace(log.header, configuration=flat)
    assert scene_figure(dataclasses.replace(log, header=header))["data"] == []
    physics = load_configuration("articulated", [*FIELD, "machine.kind=physics"]).to_toml()
    header = dataclasses.replace(log.header, configuration=physics)
    ground, *_ = scene_figure(dataclasses.replace(log, header=header))["data"]  # a body that leans, whatever the ground
    assert not ground["z"].any()
    assert not ground["showscale"]
    unknown = dataclasses.replace(log.header, configuration='of_another_version = "1"')
    assert scene_figure(dataclasses.replace(log, header=unknown))["data"] == []


def test_the_scene_fills_a_phone(log: RunLog, tmp_path: Path) -> None:
    errors = true_path_errors(log)
    report = tmp_path / "report.html"
    report.write_text(render_page(log, compute_metrics(log, errors), errors), "utf-8")
    with open_chromium() as browser:
        page = browser.new_page(viewport={"width": 360, "height": 740})
        page.goto(report.as_uri(), timeout=1e3 * LONGEST)
        page.wait_for_function("document.querySelector('#scene .gl-container canvas')", timeout=1e3 * LONGEST)
        shown, whole = page.evaluate(
            "['#scene .gl-container > div', '#scene'].map(each => document.querySelector(each).clientWidth)"
        )
    assert shown > 0.95 * whole
