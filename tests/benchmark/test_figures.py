"""Rows carry the agreed keys, and statistics are those of the times."""

import io
import json

import numpy as np
import pytest
from rich.console import Console

from drawbar.benchmark.bench import growth_table, solver_table
from drawbar.benchmark.figures import machine, microseconds, rows
from drawbar.benchmark.probe import Probe

THREE = {"median", "p99", "max"}


def test_microseconds() -> None:
    times = np.arange(1, 101) * 1e-6
    assert microseconds(times) == pytest.approx({"median": 50.5, "p99": 99.01, "max": 100.0})


def test_rows_have_the_agreed_keys(probes: list[Probe]) -> None:
    for probe in probes:
        table = rows(probe)
        assert [row["route"] for row in table] == ["drawbar", "casadi-daqp"]
        for row in table:
            assert row["problem"] == probe.name
            assert row["stages"] == probe.stages
            assert all(set(three) == THREE for three in (row["total_us"], *row["phases_us"].values()))
            assert row["prepare_us"] == row["phases_us"]["prepare"]["median"]
            assert row["feedback_us"] == row["phases_us"]["feedback"]["median"]
            assert row["floor_us"] > 0.0
        json.dumps(table, allow_nan=False)


def test_window_filling_steps_are_left_out(probes: list[Probe]) -> None:
    probe = probes[0]
    kept = probe.prepare[:]
    probe.prepare[: probe.stages + 1] = [1.0] * (probe.stages + 1)
    assert rows(probe)[0]["phases_us"]["prepare"]["max"] < 1e6
    probe.prepare[:] = kept


def test_machine_says_what_was_used() -> None:
    assert {"processor", "compiler", "python", "casadi"} <= machine().keys()


def test_tables_show_every_problem() -> None:
    three = {"median": 1.0, "p99": 2.0, "max": 3.0}
    timed = {"prepare_us": 1.0, "feedback_us": 1.0, "total_us": three, "floor_us": 1.0}
    table = [
        {"problem": name, "stages": stages, "route": "drawbar", "bounded_share": 0.5, **timed}
        for name in ("paper-tractor", "paper-trailer")
        for stages in (15, 30, 60, 120)
    ]
    console = Console(file=io.StringIO(), width=140)
    console.print(solver_table(table), growth_table(table))
    shown = console.file.getvalue()  # type: ignore[attr-defined]
    assert shown.count("paper-tractor") == shown.count("paper-trailer") == 2
