import errno
import io
import json
import os
import re
from pathlib import Path

import pytest
from rich.console import Console

from drawbar.errors import DrawbarError, StorageError
from drawbar.recording.log import LOG_NAME
from drawbar.recording.recorder import Recorder
from drawbar.report.console import summary
from drawbar.report.folder import write_report
from drawbar.report.metrics import compute_metrics
from drawbar.report.path_errors import estimated_path_errors


def record(folder, log):
    with Recorder(folder / LOG_NAME, log.header) as recorder:
        for step in log.records:
            recorder.write(step)


def test_the_report_of_a_recorded_run_is_that_of_the_run(tmp_path, run):
    record(tmp_path, run)
    metrics = write_report(tmp_path)
    assert (tmp_path / "metrics.json").read_bytes() == metrics.to_json()
    assert json.loads(metrics.to_json())["finished"] is True
    assert (tmp_path / "report.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert (tmp_path / "map.svg").read_text(encoding="utf-8").startswith("<svg")


@pytest.mark.parametrize(("code", "says"), [(errno.ENOSPC, True), (errno.EACCES, False)])
def test_a_report_that_cannot_be_written_advises_to_free_space_where_that_helps(tmp_path, run, monkeypatch, code, says):
    record(tmp_path, run)

    def fail(path, content):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(Path, "write_bytes", fail)
    with pytest.raises(StorageError, match=r"choose another folder, `drawbar report .* --out FOLDER`") as refused:
        write_report(tmp_path)
    assert ("free space" in str(refused.value)) == says


def test_a_log_cut_short_still_gives_a_report(tmp_path, make_run, monkeypatch):
    monkeypatch.setattr("drawbar.recording.recorder._HELD_BACK", 0)
    log = make_run(steps=20)
    with Recorder(tmp_path / LOG_NAME, log.header) as recorder:
        for step in log.records[:12]:
            recorder.write(step)
        cut = (tmp_path / LOG_NAME).read_bytes()
    (tmp_path / LOG_NAME).write_bytes(cut)
    metrics = write_report(tmp_path)
    assert not metrics.finished
    assert metrics.duration_s == pytest.approx(11 * 0.2, rel=1e-12)
    assert "Stopped before the end" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_a_damaged_log_gives_a_report_that_says_what_is_lost(tmp_path, make_run, monkeypatch):
    monkeypatch.setattr("drawbar.recording.chunk.CHUNK_BYTES", 5_000)
    record(tmp_path, make_run(steps=20))
    data = bytearray((tmp_path / LOG_NAME).read_bytes())
    data[data.index(b"\0\1\0\0", data.index(b"\0\1\0\0") + 9_000) + 300] ^= 1
    (tmp_path / LOG_NAME).write_bytes(data)
    metrics = write_report(tmp_path)
    (said,) = metrics.losses
    assert re.search(r"bytes \d+ to \d+ are damaged: (steps \d+ to \d+ are|step \d+ is) lost", said)
    assert said in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "metrics.json").read_text())["losses"] == [said]
    console = Console(file=io.StringIO(), width=200)
    console.print(summary(metrics))
    assert said in console.file.getvalue()


def test_a_report_that_cannot_be_written_is_named(tmp_path, make_run):
    record(tmp_path, make_run(steps=2))
    (tmp_path / "report.html").mkdir()
    with pytest.raises(DrawbarError, match=r"the report's report.html cannot be written \(Is a directory\)"):
        write_report(tmp_path)
    assert (tmp_path / "metrics.json").exists()
    assert (tmp_path / "map.svg").exists()


def test_the_advice_names_the_log_where_a_report_elsewhere_cannot_be_written(tmp_path, make_run):
    record(tmp_path, make_run(steps=2))
    (tmp_path / "taken").touch()
    with pytest.raises(DrawbarError, match=rf"taken: .*, `drawbar report {tmp_path / LOG_NAME} --out FOLDER`"):
        write_report(tmp_path / "taken", tmp_path / LOG_NAME)


def test_a_run_whose_truth_nobody_knows_has_a_report_of_its_estimates(tmp_path, make_run):
    log = make_run(truth=False, steps=20)
    record(tmp_path, log)
    metrics = write_report(tmp_path)
    assert metrics.error_estimated
    assert metrics.error_m.tractor["all"] == compute_metrics(log, estimated_path_errors(log)).error_m.tractor["all"]
    assert metrics.error_m.tractor["all"].max > 0.0
