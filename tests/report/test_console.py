import dataclasses
import io

import pytest
from rich.cells import cell_len
from rich.console import Console

from drawbar.recording.log import Outcome
from drawbar.report import progress as module
from drawbar.report.console import summary
from drawbar.report.metrics import compute_metrics
from drawbar.report.path_errors import true_path_errors
from drawbar.report.progress import RunProgress, progress_line
from drawbar.report.tables import counted, number


def printed(renderable):
    console = Console(file=io.StringIO(), width=80)
    console.print(renderable)
    return console.file.getvalue()


def metrics_of(log):
    return compute_metrics(log, true_path_errors(log))


def test_the_summary_fits_80_columns_and_is_not_cut(run):
    text = printed(summary(metrics_of(run)))
    assert max(cell_len(row.rstrip()) for row in text.splitlines()) <= 80
    assert "…" not in text
    assert "\x1b" not in text


def test_a_seed_is_of_a_simulation_only(run):
    metrics = metrics_of(run)
    assert f"articulated, seed {metrics.seed}: " in printed(summary(metrics))
    assert "articulated: " in printed(summary(dataclasses.replace(metrics, error_estimated=True)))


def test_the_summary_shows_the_figures_in_their_units(run):
    metrics = metrics_of(run)
    text = printed(summary(metrics))
    rows = {row.split("  ")[0]: row.split() for row in text.splitlines() if row}
    (shown,) = (row.split()[-10:] for row in text.splitlines() if row.startswith("curve 0.15/m"))
    for body, cells in ((metrics.error_m.tractor, shown[:5]), (metrics.error_m.trailer, shown[5:])):
        error = body["0.15"]
        values = (error.mean, error.rms, error.deviation, error.p95, error.max)
        assert cells == [f"{100 * value:.1f}" for value in values]
    assert rows["tractor, feedback"][-3] == f"{1e6 * metrics.solve_time_s.tractor.feedback.median:.1f}"


def test_a_long_run_with_a_reason_still_fits(make_run):
    log = make_run(steps=10, outcome=Outcome(finished=False, reason="SolverError: " + "very " * 40 + "bad"))
    text = printed(summary(metrics_of(log)))
    assert max(cell_len(row.rstrip()) for row in text.splitlines()) <= 80
    assert "stopped: SolverError" in text


def test_of_a_run_without_figures_only_its_end_is_reported(make_run):
    log = make_run(steps=0, outcome=Outcome(finished=False, reason="port 9999 is taken"))
    told = printed(summary(metrics_of(log)))
    assert "stopped: port 9999 is taken" in told
    assert len(told.splitlines()) == 4


@pytest.mark.parametrize("length", [1.0, 343.5, 99_999.0])
def test_the_progress_line_fits_80_columns(run, length):
    record = run.records[-1]
    reference = dataclasses.replace(
        record.reference, tractor=dataclasses.replace(record.reference.tractor, progress=length)
    )
    line = progress_line(dataclasses.replace(record, reference=reference), length, 0.5).plain
    assert cell_len(line) <= 80
    assert "100%" in line


def test_one_is_in_the_singular():
    assert [counted(each, "step") for each in (0, 1, 2)] == ["0 steps", "1 step", "2 steps"]


def test_zero_has_no_sign(run):
    record = run.records[0]
    nothing = dataclasses.replace(record.reference.tractor, progress=-0.2, lateral_error=-1e-4)
    reference = dataclasses.replace(record.reference, tractor=nothing)
    line = progress_line(dataclasses.replace(record, reference=reference), 344.0, 0.5).plain
    assert "     0 of 344 m" in line
    assert "tractor   +0.0" in line
    assert number(-0.04, 1, " %") == "0.0 %"


def test_without_a_terminal_there_are_plain_lines_and_few(run, monkeypatch):
    clock = iter(0.01 * k for k in range(10**6))
    monkeypatch.setattr(module.time, "perf_counter", lambda: next(clock))
    console = Console(file=io.StringIO(), width=60)
    with RunProgress(console, 343.5) as progress:
        for record in run.records:  # 18 s of wall-clock time
            progress.show(record)
    text = console.file.getvalue()
    assert len(text.splitlines()) == 3, "after 5, 10 and 15 s, each in one line"
    assert "\x1b" not in text
    assert "\r" not in text


def test_a_terminal_is_drawn_at_most_five_times_a_second(run, monkeypatch):
    clock = iter(0.01 * k for k in range(10**6))
    drawn = []
    monkeypatch.setattr(module.time, "perf_counter", lambda: next(clock))
    monkeypatch.setattr(module, "progress_line", lambda *_: drawn.append(1) or "")
    console = Console(file=io.StringIO(), width=80, force_terminal=True)
    with RunProgress(console, 343.5) as progress:
        for record in run.records[:500]:  # 5 s
            progress.show(record)
    assert 20 <= len(drawn) <= 26


def test_a_drive_that_was_never_steered_has_no_tables_of_dashes(never_steered):
    text = printed(summary(metrics_of(never_steered)))
    assert "solver, µs" in text
    assert "error, cm" not in text
    assert "yaw error" not in text
    assert not [row for row in text.splitlines() if set(row.split()[1:]) == {"–"}]


def test_parts_of_the_path_that_were_not_reached_are_left_out(run):
    reached = dataclasses.replace(run, records=run.records[: len(run.records) // 50])
    rows = [row.split()[0] for row in printed(summary(metrics_of(reached))).splitlines() if row]
    assert "straight" in rows
    assert "curve" not in rows
    assert "curve" in [row.split()[0] for row in printed(summary(metrics_of(run))).splitlines() if row]
