"""Columns read in a stream are those of the whole log."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from arbitrary_logs import arbitrary_step, header, write, write_as_json

from drawbar.errors import DrawbarError
from drawbar.recording import columns
from drawbar.recording.columns import WIDE, read_columns, reported
from drawbar.recording.log import read_log
from drawbar.recording.recorder import Recorder
from drawbar.step import layout


def test_columns_are_those_of_the_whole_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(columns, "_BLOCK", 7)
    write(tmp_path / "log.mcap", 30)
    whole, streamed = read_log(tmp_path / "log.mcap"), read_columns(tmp_path / "log.mcap")
    for name in reported(has_truth=True):
        expected = whole.column(name)
        exact = name.endswith(WIDE)
        np.testing.assert_allclose(streamed.column(name), expected, rtol=0.0 if exact else 1e-7, err_msg=name)
    assert (streamed.steps, streamed.has_truth, streamed.outcome) == (30, True, whole.outcome)
    np.testing.assert_array_equal(streamed.wall_time, whole.wall_time)


def test_columns_of_logs_whose_steps_are_json_are_those_of_the_whole_log(tmp_path: Path) -> None:
    write_as_json(tmp_path / "log.mcap", 3)
    whole, read = read_log(tmp_path / "log.mcap"), read_columns(tmp_path / "log.mcap")
    assert read.steps == 3
    for name in reported(has_truth=True):
        np.testing.assert_array_equal(read.column(name), whole.column(name), err_msg=name)


def test_a_column_that_a_log_lacks_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    schema = layout.step_schema(2)
    earlier = "\n".join(line for line in schema.splitlines() if "trailer_slip" not in line) + "\n"
    assert earlier != schema
    monkeypatch.setattr("drawbar.recording.recorder.step_schema", lambda stages: earlier)
    monkeypatch.setattr("drawbar.recording.recorder.packed", layout.StepLayout.of_schema(earlier).pack)
    steps = write(tmp_path / "log.mcap", 9)
    log = read_columns(tmp_path / "log.mcap", ["estimate.trailer_slip", "estimate.steering_offset"])
    assert np.isnan(log.column("estimate.trailer_slip")).all()
    offsets = [step.estimate.steering_offset for step in steps]
    np.testing.assert_allclose(log.column("estimate.steering_offset"), offsets, rtol=1e-7)


def test_a_number_that_stays_the_same_is_kept_once(tmp_path: Path) -> None:
    still, moving = "command.speed", "measurement.time"
    steps = [replace(arbitrary_step(seed), command=arbitrary_step(0).command) for seed in range(9)]
    with Recorder(tmp_path / "log.mcap", header()) as recorder:
        for step in steps:
            recorder.write(step)
    log = read_columns(tmp_path / "log.mcap", [still, moving])
    assert [len(column) for column in log.blocks[0].columns.values()] == [1, 9]
    np.testing.assert_allclose(log.column(still), np.full(9, steps[0].command.speed), rtol=1e-7)


def test_without_truth_its_columns_are_missing(tmp_path: Path) -> None:
    with Recorder(tmp_path / "log.mcap", header()) as recorder:
        recorder.write(replace(arbitrary_step(1), truth=None))
    log = read_columns(tmp_path / "log.mcap")
    assert not log.has_truth
    assert np.isnan(log.column("truth.tractor.x")).all()
    assert log.column("measurement.time").shape == (1,)


def test_a_log_without_steps_has_empty_columns(tmp_path: Path) -> None:
    write(tmp_path / "log.mcap", 0)
    assert read_columns(tmp_path / "log.mcap").column("measurement.time").shape == (0,)


def test_what_is_no_log_is_refused(tmp_path: Path) -> None:
    (tmp_path / "log.mcap").write_bytes(b"not a log")
    with pytest.raises(DrawbarError, match=r"log\.mcap: "):
        read_columns(tmp_path / "log.mcap")
