"""Figures carry the agreed keys, and statistics are those of the times."""

import io
import json

import numpy as np
import pytest
from rich.console import Console

from drawbar.benchmark.figures import machine, microseconds, race_rows, row
from drawbar.benchmark.probe import Probe
from drawbar.benchmark.tables import bounds_table, growth_table, race_growth_table, race_table, solver_table

FOUR = {"median", "mean", "p99", "max"}


def test_figures_of_times_are_their_median_mean_percentile_and_largest() -> None:
    times = np.append(np.arange(1, 100), 200) * 1e-6
    assert microseconds(times) == pytest.approx({"median": 50.5, "mean": 51.5, "p99": 100.01, "max": 200.0})


def test_rows_have_the_agreed_keys(probes: list[Probe]) -> None:
    for probe in probes:
        made = row(probe)
        assert (made["problem"], made["stages"]) == (probe.name, probe.stages)
        assert all(set(figure) == FOUR for figure in (made["total_us"], *made["phases_us"].values()))
        assert made["prepare_us"] == made["phases_us"]["prepare"]["median"]
        assert made["feedback_us"] == made["phases_us"]["feedback"]["median"]
        assert made["floor_us"] > 0.0
        json.dumps(made, allow_nan=False)


def test_bounds_active_and_free_are_told_apart(probes: list[Probe]) -> None:
    for probe in probes:
        made = row(probe)
        full = slice(probe.stages + 1, len(probe.floor))
        active = np.array(probe.iterations)[full] > 0
        times = 1e6 * np.array(probe.feedback)[full]
        assert made["bounded_share"] == active.mean()
        for figure, some in ((made["feedback_free_us"], times[~active]), (made["feedback_active_us"], times[active])):
            assert (figure is None) == (len(some) == 0)
            assert figure is None or figure["max"] == pytest.approx(some.max())


def test_window_filling_steps_are_left_out(probes: list[Probe]) -> None:
    probe = probes[0]
    kept = probe.prepare[:]
    probe.prepare[: probe.stages + 1] = [1.0] * (probe.stages + 1)
    assert row(probe)["phases_us"]["prepare"]["max"] < 1e6
    probe.prepare[:] = kept


def test_machine_says_what_was_used() -> None:
    assert {"processor", "compiler", "python", "casadi"} <= machine().keys()


def test_tables_show_every_problem(probes: list[Probe]) -> None:
    rows = [{**row(probe), "stages": stages} for probe in probes for stages in (15, 30, 60, 120)]
    peers = [{**each, "stages": stages} for probe in probes for each in race_rows(probe) for stages in (15, 120)]
    console = Console(file=io.StringIO(), width=140)
    console.print(solver_table(rows, 15), bounds_table(rows, 15), growth_table(rows))
    shown = console.file.getvalue()  # type: ignore[attr-defined]
    assert all(shown.count(probe.name) == 3 for probe in probes)
    console.print(race_table(peers, 15), race_growth_table(peers))
    shown = console.file.getvalue()  # type: ignore[attr-defined]
    assert all(shown.count(probe.name) >= 4 for probe in probes)
