import dataclasses
import json
import math

import numpy as np
import pytest

from drawbar.report.figures import error_figure
from drawbar.report.metrics import compute_metrics, error_statistics
from drawbar.report.path_errors import Bodies, PathErrors, project_track, true_path_errors
from drawbar.signals import FixStatus, Flag, GateVerdict, Status


def paths_errors(error, labels):
    return PathErrors(progress=np.arange(len(error)), error=np.array(error), **of_classes(labels))


def of_classes(labels):
    names = tuple(dict.fromkeys(labels))
    return {"classes": np.array([names.index(label) for label in labels], dtype=np.int8), "label_names": names}


def nested_replace(record, path, value):
    name, _, rest = path.partition(".")
    return dataclasses.replace(record, **{name: nested_replace(getattr(record, name), rest, value) if rest else value})


def with_column(log, path, values):
    records = [nested_replace(r, path, v) for r, v in zip(log.records, values, strict=True)]
    return dataclasses.replace(log, records=tuple(records))


def small(make_run, count=4):
    return make_run(steps=count)


def test_error_statistics_by_hand():
    statistics = error_statistics(np.array([3.0, -4.0, np.nan]))
    assert statistics.mean == 3.5
    assert statistics.rms == pytest.approx(math.sqrt(12.5), rel=1e-15)
    assert statistics.max == 4.0


def test_errors_are_told_apart_by_class(make_run):
    log = small(make_run)
    labels = ["straight", "0.1", "0.1", "straight"]
    errors = Bodies(
        tractor=paths_errors([0.01, -0.02, 0.04, 0.03], labels),
        trailer=paths_errors([0.0, 0.1, 0.1, np.nan], labels),
    )
    error = compute_metrics(log, errors).error_m
    assert error.tractor["straight"].mean == pytest.approx(0.02, rel=1e-12)
    assert error.tractor["0.1"].mean == pytest.approx(0.03, rel=1e-12)
    assert error.tractor["0.1"].max == 0.04
    assert error.tractor["all"].mean == pytest.approx(0.025, rel=1e-12)
    assert error.trailer["straight"].max == 0.0
    assert math.isnan(error.trailer["0.125"].mean)


def test_what_the_gate_did_is_counted(make_run):
    log = with_column(small(make_run), "gate", [GateVerdict.LIMITED, *list(GateVerdict)[1:]])
    metrics = compute_metrics(log, true_path_errors(log))
    assert (metrics.limited_commands, metrics.refused_commands) == (2, 2)


def test_masked_fixes_of_both_antennas_are_counted(make_run):
    log = small(make_run)
    accepted, missing, stale, rejected = FixStatus
    log = with_column(log, "estimate.tractor_fix", [accepted, stale, rejected, missing])
    log = with_column(log, "estimate.trailer_fix", [stale, stale, accepted, accepted])
    metrics = compute_metrics(log, true_path_errors(log))
    assert (metrics.stale_fixes, metrics.rejected_fixes) == (3, 1)
    crosses = [trace for trace in error_figure(log, true_path_errors(log))["data"] if trace.get("mode") == "markers"]
    assert [(trace["name"], len(trace["x"])) for trace in crosses] == [
        ("Tractor, fix not believed", 2),
        ("Trailer, fix not believed", 2),
    ]


def test_shares_are_those_computed_by_hand(make_run):
    log = small(make_run)
    log = with_column(log, "tractor_steering.command", [0.2, -0.2, 0.1, 0.0])
    log = with_column(log, "tractor_steering.ancillary", [0.05, -0.05, 0.0, 0.0])
    log = with_column(log, "trailer_steering.command", [0.0] * 4)
    log = with_column(log, "trailer_steering.saturated", [True, False, False, False])
    metrics = compute_metrics(log, true_path_errors(log))
    assert metrics.ancillary_share.tractor == pytest.approx(0.2, rel=1e-12)
    assert math.isnan(metrics.ancillary_share.trailer)  # nothing was commanded: no share
    assert metrics.saturated_share == Bodies(tractor=0.0, trailer=0.25)


def test_the_least_margin_is_that_of_the_steps_with_a_tube(make_run):
    log = small(make_run)
    log = with_column(log, "tractor_steering.margin", [0.5, -0.25, math.nan, 1.0])
    log = with_column(log, "trailer_steering.margin", [math.nan] * 4)
    margin = compute_metrics(log, true_path_errors(log)).tube_margin_min
    assert margin.tractor == -0.25
    assert math.isnan(margin.trailer)


def test_steps_with_the_steering_at_its_limit_are_counted_where_it_is_known(make_run):
    log = small(make_run)
    limit = log.header.vehicle.trailer_steering_limit
    log = with_column(log, "truth.trailer_steering", [limit, -limit + 0.008, limit - 0.01, 0.0])
    log = with_column(log, "truth.tractor_steering", [math.nan] * 4)
    share = compute_metrics(log, true_path_errors(log)).at_limit_share
    assert share.trailer == 0.5
    assert math.isnan(share.tractor)


def test_steering_and_commands_while_the_driver_steers_are_nobodys_figures(make_run):
    log = small(make_run)
    limit = log.header.vehicle.tractor_steering_limit
    log = with_column(log, "flags", [Flag.RELEASED, Flag.RELEASED, Flag(0), Flag(0)])
    log = with_column(log, "gate", [GateVerdict.STOPPED, GateVerdict.LIMITED, GateVerdict.LIMITED, GateVerdict.PASSED])
    log = with_column(log, "truth.tractor_steering", [limit, limit, 0.0, 0.02])
    log = with_column(log, "tractor_steering.command", [0.5, 0.5, 0.1, 0.1])
    log = with_column(log, "tractor_steering.ancillary", [0.5, 0.5, 0.05, 0.05])
    log = with_column(log, "tractor_steering.saturated", [True, True, True, False])
    log = with_column(log, "tractor_steering.margin", [-1.0, 0.1, 0.5, 0.6])
    log = with_column(log, "measurement.time", [0.0, 0.2, 0.4, 0.6])
    metrics = compute_metrics(log, true_path_errors(log))
    assert (metrics.limited_commands, metrics.refused_commands) == (1, 0)
    assert metrics.at_limit_share.tractor == 0.0
    assert metrics.steering_rate_mean_rad_s.tractor == pytest.approx(0.1, rel=1e-12)
    assert metrics.ancillary_share.tractor == pytest.approx(0.5, rel=1e-12)
    assert metrics.saturated_share.tractor == 0.5
    assert metrics.tube_margin_min.tractor == 0.5


def test_waiting_before_a_run_and_after_it_is_no_failure_and_no_way(make_run):
    log = small(make_run, 5)
    log = with_column(log, "status", [Status.START, Status.POSITION, Status.OK, Status.OK, Status.BLIND])
    stopped, passed = GateVerdict.STOPPED, GateVerdict.PASSED
    log = with_column(log, "gate", [stopped, stopped, passed, passed, stopped])
    log = with_column(log, "solver_failures", [2, 2, 1, 0, 2])
    log = with_column(log, "estimate.tractor.yaw", [math.nan, math.nan, 0.0, 0.0, math.nan])
    log = with_column(log, "reference.tractor.progress", [math.nan, math.nan, 3.0, 3.5, math.nan])
    metrics = compute_metrics(log, true_path_errors(log))
    assert (metrics.solver_failures, metrics.refused_commands) == (1, 0)
    assert metrics.length_m == 0.5
    log = with_column(log, "reference.tractor.progress", [math.nan] * 5)
    assert compute_metrics(log, true_path_errors(log)).length_m == 0.0


def test_yaw_error_does_not_see_whole_turns(make_run):
    log = small(make_run)
    log = with_column(log, "truth.tractor.yaw", [0.0, 0.0, 0.0, 0.0])
    log = with_column(log, "estimate.tractor.yaw", [0.1, 2 * math.pi - 0.1, 0.1, -0.1 - 4 * math.pi])
    assert compute_metrics(log, true_path_errors(log)).yaw_rmse_rad.tractor == pytest.approx(0.1, rel=1e-12)


def test_the_steering_rate_is_that_of_the_true_angle(make_run):
    log = with_column(small(make_run), "truth.trailer_steering", [0.0, 0.04, 0.0, -0.02])
    log = with_column(log, "measurement.time", [0.0, 0.2, 0.4, 0.5])
    assert compute_metrics(log, true_path_errors(log)).steering_rate_mean_rad_s.trailer == pytest.approx(0.2, rel=1e-12)
    log = make_run(steps=4, truth=False)
    log = with_column(log, "measurement.tractor_steering", [0.0, 0.02, np.nan, -0.02])
    assert compute_metrics(log, true_path_errors(log)).steering_rate_mean_rad_s.tractor == pytest.approx(0.1, rel=1e-12)


def test_the_steering_rate_on_straights_leaves_out_the_curves(make_run):
    log = with_column(small(make_run), "truth.trailer_steering", [0.0, 0.04, 0.0, -0.02])
    log = with_column(log, "measurement.time", [0.0, 0.2, 0.4, 0.8])
    errors = true_path_errors(log)
    classes = of_classes(["straight", "0.1", "straight", "straight"])
    labelled = dataclasses.replace(errors, trailer=dataclasses.replace(errors.trailer, **classes))
    metrics = compute_metrics(log, labelled)
    assert metrics.steering_rate_straight_rad_s.trailer == pytest.approx((0.2 + 0.05) / 2, rel=1e-12)


def test_times_and_totals_by_hand(make_run):
    log = small(make_run, 101)
    log = with_column(log, "estimator_times.feedback", [k * 1e-6 for k in range(101)])
    log = with_column(log, "solver_failures", [2] + [0] * 99 + [1])
    log = dataclasses.replace(log, wall_time=1e9 + np.linspace(0.0, 0.5, 101))
    metrics = compute_metrics(log, true_path_errors(log))
    times = metrics.solve_time_s.estimator.feedback
    assert (times.median, times.p99, times.max) == pytest.approx((50e-6, 99e-6, 100e-6), rel=1e-12)
    assert metrics.solver_failures == 3
    assert metrics.duration_s == pytest.approx(20.0, rel=1e-12)
    assert metrics.real_time_factor == pytest.approx(40.0, rel=1e-6)  # the clock resolves 1e9 s to 1e-7 s
    assert metrics.length_m == pytest.approx(19.0, rel=1e-12)


def test_without_truth_there_are_nulls_and_nothing_invented(make_run):
    log = make_run(truth=False, steps=30)
    written = json.loads(compute_metrics(log, true_path_errors(log)).to_json())
    assert written["yaw_rmse_rad"] == {"tractor": None, "trailer": None}
    for body in ("tractor", "trailer"):
        for statistics in written["error_m"][body].values():
            assert statistics == dict.fromkeys(("mean", "rms", "max", "deviation", "p95"))
    assert written["saturated_share"]["tractor"] == 0.0
    assert written["error_estimated"]
    assert not json.loads(compute_metrics(make_run(steps=2), true_path_errors(make_run(steps=2))).to_json())[
        "error_estimated"
    ]


def test_a_run_that_died_before_its_first_step_has_figures(make_run):
    log = make_run(steps=0)
    metrics = compute_metrics(log, true_path_errors(log))
    assert (metrics.length_m, metrics.duration_s, metrics.solver_failures) == (0.0, 0.0, 0)
    assert math.isnan(metrics.real_time_factor)


def test_the_json_holds_every_promised_key(run):
    written = json.loads(compute_metrics(run, true_path_errors(run)).to_json())
    promised = {
        *("config", "seed", "finished", "duration_s", "length_m", "real_time_factor", "error_m"),
        *(
            "yaw_rmse_rad",
            "steering_rate_mean_rad_s",
            "steering_rate_straight_rad_s",
            "ancillary_share",
            "saturated_share",
            "at_limit_share",
            "tube_margin_min",
            "solver_failures",
            "solve_time_s",
        ),
    }
    assert promised <= written.keys()
    assert written["error_m"]["trailer"].keys() == {"straight", "0.1", "0.125", "0.15", "all"}
    assert written["solve_time_s"]["trailer"]["feedback"].keys() == {"median", "p99", "max"}


def test_the_same_seed_gives_the_same_bytes_apart_from_times(make_run):
    def without_times(log):
        metrics = compute_metrics(log, true_path_errors(log))
        fixed = compute_metrics(make_run(steps=2), true_path_errors(make_run(steps=2))).solve_time_s
        return dataclasses.replace(metrics, solve_time_s=fixed, real_time_factor=1.0).to_json()

    slower = dataclasses.replace(make_run(seed=4), wall_time=np.arange(1e4))
    assert without_times(make_run(seed=4)) == without_times(slower)
    assert without_times(make_run(seed=4)) != without_times(make_run(seed=5))


def test_a_track_beside_the_path_is_found_through_the_crossing(run):
    path = run.header.path.path()
    progress = np.arange(0.0, path.length, 0.3)
    samples = path.sample(progress)
    left = 0.2 * np.column_stack([-np.sin(samples[:, 2]), np.cos(samples[:, 2])])
    found = project_track(path, *(samples[:, :2] + left).T, start=0.0)
    np.testing.assert_allclose(found.error, 0.2, atol=1e-6)
    np.testing.assert_allclose(found.progress, progress, atol=1e-5)
    assert [found.label_names[each] for each in found.classes] == path.labels(found.progress)


def test_a_gap_in_the_truth_stays_a_gap(run):
    path = run.header.path.path()
    x = np.array([1.0, np.nan, 1.4])
    found = project_track(path, x, np.full(3, 0.1), start=1.0)
    np.testing.assert_array_equal(np.isnan(found.error), [False, True, False])
