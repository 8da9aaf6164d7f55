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
