"""A body without a solver of its own (centralised control) is missing in tables, figure and JSON."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from drawbar.report.figures import solve_time_figure
from drawbar.report.metrics import compute_metrics
from drawbar.report.path_errors import true_path_errors
from drawbar.report.tables import time_rows
from drawbar.signals import SolveTimes

NOTHING = SolveTimes(prepare=math.nan, feedback=math.nan)


@pytest.fixture
def without(make_run):
    """Return a function that makes a log in which some solvers are missing."""

    def without(*solvers):
        log, missing = make_run(steps=50), {f"{solver}_times": NOTHING for solver in solvers}
        return replace(log, records=tuple(replace(record, **missing) for record in log.records))

    return without


def test_metrics_tell_the_missing_solver_from_a_quick_one(without):
    log = without("trailer")
    metrics = compute_metrics(log, true_path_errors(log))
    times = json.loads(metrics.to_json())["solve_time_s"]
    assert times["trailer"] == {phase: dict.fromkeys(("median", "p99", "max")) for phase in ("prepare", "feedback")}
    assert times["tractor"]["feedback"]["median"] > 0.0
    rows = dict(time_rows(metrics))
    assert rows["trailer, prepare"] == rows["trailer, feedback"] == ["–"] * 3
    assert "–" not in rows["tractor, feedback"]


def test_the_figure_draws_the_solvers_that_there_are(without):
    names = [trace["name"] for trace in solve_time_figure(without("trailer"))["data"]]
    assert names == [f"{solver}, {phase}" for solver in ("Estimator", "Tractor") for phase in ("prepare", "feedback")]
    shares = [np.nansum(trace["y"]) for trace in solve_time_figure(without("trailer"))["data"]]
    assert min(shares) > 0.0


def test_the_figure_of_no_solver_is_empty(without):
    assert solve_time_figure(without("estimator", "tractor", "trailer"))["data"] == []


@pytest.mark.parametrize(("longest", "ticks"), [(50e-6, [1, 2, 5, 10, 20, 50, 100]), (50e-3, [1, 10, 100])])
def test_every_time_on_the_axis_has_all_its_digits(make_run, longest, ticks):
    times = SolveTimes(prepare=1e-6, feedback=longest)
    log = make_run(steps=50)
    log = replace(log, records=tuple(replace(record, tractor_times=times) for record in log.records))
    axis = solve_time_figure(log)["layout"]["xaxis"]
    assert [tick for tick in axis["tickvals"] if 1 <= tick <= 100] == ticks
    assert axis["tickformat"] == "~g"
