"""Errors are those from the line that was followed, also where that leads beside the path."""

import dataclasses
import time
from itertools import islice
from pathlib import Path

import msgspec
import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.geometry import Floats
from drawbar.guidance.path import Path as Line
from drawbar.recording.columns import read_columns
from drawbar.recording.log import Outcome, RunLog
from drawbar.recording.recorder import Recorder
from drawbar.report.map import map_figure
from drawbar.report.path_errors import _project_stretches, estimated_path_errors, true_path_errors
from drawbar.signals import Flag, StepRecord
from drawbar.simulation import Simulation

NUDGE = 0.3
SHIFTED = 110
"""steps after which both bodies have left the shift behind"""


def driven(*changes: str, nudge: float = NUDGE) -> RunLog:
    """Return the log of a run that is nudged after 40 steps, on a straight."""
    changes = ("path.radii=[8.0]", *changes)
    with Simulation(load_configuration("articulated", list(changes))) as simulation:
        records = list[StepRecord]()
        for record in islice(simulation.steps(), 240):
            records.append(record)
            if record.step == 40:
                simulation.autopilot.set_offset(nudge)
        return RunLog(
            header=simulation.header(),
            records=tuple(records),
            wall_time=np.full(len(records), time.time()),
            outcome=Outcome(finished=True, reason=""),
        )


def beside(log: RunLog, body: str) -> Floats:
    """Return how far left of the path a body's tracked point truly was, m."""
    path, (x, y, yaw) = log.header.path.path(), [log.column(f"truth.{body}.{name}") for name in ("x", "y", "yaw")]
    forward, left = getattr(log.header.vehicle.tracked, body).arm
    x, y = x + forward * np.cos(yaw) - left * np.sin(yaw), y + forward * np.sin(yaw) + left * np.cos(yaw)
    return path.project_track(x, y, 0.0, behind=1.0, ahead=3.0)[1]


@pytest.fixture(scope="module")
def nudged() -> RunLog:
    return driven("path.straight_length=25.0")


@pytest.mark.parametrize("body", ["tractor", "trailer"])
def test_a_nudged_run_is_judged_beside_the_path_also_in_its_curves(nudged: RunLog, body: str) -> None:
    errors, places = getattr(true_path_errors(nudged), body), beside(nudged, body)
    curved = errors.of_class("0.125")
    np.testing.assert_array_equal(errors.error[:40], places[:40])
    np.testing.assert_allclose((places - errors.error)[SHIFTED:], NUDGE, atol=1e-4)
    assert curved[SHIFTED:].sum() > 50
    assert np.abs(errors.error[20:]).max() < 0.12


TOOLS = ("vehicle.tracked.tractor.forward=-0.5", "vehicle.tracked.trailer={ forward = -0.6, left = 0.05 }")


@pytest.fixture(scope="module")
def tools() -> RunLog:
    return driven("path.straight_length=25.0", "vehicle.dead_time=0.2", *TOOLS)


@pytest.mark.parametrize("body", ["tractor", "trailer"])
def test_tools_of_a_nudged_run_are_judged_beside_the_path_too(tools: RunLog, body: str) -> None:
    errors, places = getattr(true_path_errors(tools), body), beside(tools, body)
    np.testing.assert_array_equal(errors.error[:40], places[:40])
    np.testing.assert_allclose((places - errors.error)[SHIFTED:], NUDGE, atol=1e-4)
    assert errors.of_class("0.125")[SHIFTED:].sum() > 50
    assert np.abs(errors.error[20:]).max() < 0.15


@pytest.mark.parametrize("run", ["nudged", "tools"])
def test_a_report_of_the_logs_columns_says_the_same(run: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    log: RunLog = request.getfixturevalue(run)
    with Recorder(tmp_path / "log.mcap", log.header) as recorder:
        for record in log.records:
            recorder.write(record)
    errors = true_path_errors(read_columns(tmp_path / "log.mcap")).trailer.error
    np.testing.assert_allclose(
        errors, true_path_errors(log).trailer.error, atol=2e-7 if run == "tools" else 1e-9
    )  # yaws are single


def test_what_is_not_known_of_the_line_stays_as_it_was(nudged: RunLog) -> None:
    def without(record: StepRecord) -> StepRecord:
        body = dataclasses.replace(record.reference.tractor, closest=np.full(4, np.nan))
        return dataclasses.replace(record, reference=dataclasses.replace(record.reference, tractor=body))

    gap = [without(record) if 100 <= record.step < 105 else record for record in nudged.records]
    log = dataclasses.replace(nudged, records=tuple(gap))
    whole, found = (true_path_errors(each).tractor.error for each in (nudged, log))
    np.testing.assert_allclose(found, whole, atol=1e-4)
    log = dataclasses.replace(nudged, records=tuple(map(without, nudged.records)))
    np.testing.assert_array_equal(true_path_errors(log).tractor.error, beside(nudged, "tractor"))


def test_a_run_on_its_path_is_judged_by_the_path_bit_for_bit() -> None:
    log = driven(nudge=0.0)
    np.testing.assert_array_equal(true_path_errors(log).trailer.error, beside(log, "trailer"))


@pytest.mark.parametrize("run", ["nudged", "tools"])
def test_the_map_shows_the_line_beside_the_path(run: str, request: pytest.FixtureRequest) -> None:
    log = request.getfixturevalue(run)
    traces = map_figure(log)["data"]
    line = next(trace for trace in traces if trace["name"] == "Line beside the path")
    track = next(trace for trace in traces if trace["name"] == "Tractor" and trace.get("meta") == "steps")
    line, tracked = (np.column_stack([trace["x"], trace["y"]]) for trace in (line, track))
    apart = np.linalg.norm(line - tracked[: len(line)], axis=1)
    assert apart[SHIFTED:].max() < 0.2, "the line and the tracked point follow each other"
    left = log.header.path.path().project_track(*line.T, 0.0, behind=1.0, ahead=3.0)[1]
    np.testing.assert_allclose(left[SHIFTED:], NUDGE, atol=2e-3)


def test_the_map_of_a_run_on_its_path_shows_no_other_line() -> None:
    names = {trace["name"] for trace in map_figure(driven(nudge=0.0))["data"]}
    assert "Path" in names
    assert "Line beside the path" not in names


@pytest.mark.parametrize("body", ["tractor", "trailer"])
def test_what_was_driven_by_hand_before_or_between_does_not_lead_the_judgement_astray(body: str) -> None:
    log = driven("path.straight_length=25.0", nudge=0.0)
    by_hand = {*range(60), *range(100, 160)}  # each 12 m: more than is searched ahead of the last place
    records = tuple(
        msgspec.structs.replace(record, flags=record.flags | Flag.RELEASED) if record.step in by_hand else record
        for record in log.records
    )
    steered = np.array([record.step not in by_hand for record in records])
    found = getattr(estimated_path_errors(dataclasses.replace(log, records=records)), body)
    whole = getattr(estimated_path_errors(log), body)
    np.testing.assert_array_equal(np.isfinite(found.error), steered)
    np.testing.assert_allclose(found.error[steered], whole.error[steered], atol=1e-6)
    np.testing.assert_allclose(found.progress[steered], whole.progress[steered], atol=1e-3)


def test_a_pass_driven_the_other_way_is_found_where_it_is() -> None:
    x = np.linspace(0.0, 100.0, 101)
    labels = np.zeros(100, np.int8)
    path = Line.through(arc_length=x, x=x, y=0.0 * x, yaw=0.0 * x, label_of_piece=labels, label_names=("line",))
    track = np.column_stack([np.linspace(80.0, 60.0, 40), np.full(40, 3.0)])
    near = 100.0 - track[:, 0]  # of the path from its end
    found = _project_stretches(path, track, near, np.zeros(40, dtype=bool))
    np.testing.assert_allclose(found.error, 3.0, atol=1e-9)
    np.testing.assert_allclose(found.progress, track[:, 0], atol=1e-6)


@pytest.mark.parametrize("start", ["start.left=2.5", "start.left=-3.0", "start.yaw=1.5708"])
def test_a_run_that_begins_beside_the_crossing_is_judged_on_the_branch_that_it_follows(start: str) -> None:
    log = driven(start, nudge=0.0)
    true = true_path_errors(log)
    for body, errors in (("tractor", true.tractor), ("trailer", true.trailer)):
        estimated = np.array([getattr(record.reference, body).lateral_error for record in log.records])
        assert np.abs(errors.error - estimated).max() < 0.2


def test_a_body_behind_the_path_is_found_there_although_the_first_estimate_was_elsewhere() -> None:
    path = driven(nudge=0.0).header.path.path()
    along = np.arange(-6.0, 60.0, 0.2)
    near = np.maximum(along, 0.0)
    near[0] = 4.0  # a first yaw that is wrong by half a turn puts the trailer ahead of the tractor
    found = _project_stretches(path, path.sample(along)[:, :2], near, np.zeros(len(along), dtype=bool))
    np.testing.assert_allclose(found.error, 0.0, atol=1e-6)
    np.testing.assert_allclose(found.progress, along, atol=1e-3)
