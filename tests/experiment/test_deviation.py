"""The standard deviations kept beside a run are those that the estimator had at each sample."""

from dataclasses import replace

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.experiment.deviation import RecordedDeviation
from drawbar.experiment.task import Task, run_task
from drawbar.step.build import build_autopilot, build_machine, build_path

SHORT = ("path.radii=[5.0]", "path.straight_length=1.0")
ROWS = {"articulated": ("tractor_yaw", 2, "tractor_slip", 7), "paper-ekf": ("tractor_yaw", 2, "trailer_slip", 8)}


def autopilot(name: str):
    configuration = load_configuration(name, SHORT)
    path, _ = build_path(configuration)
    return configuration, build_autopilot(configuration, path, build_machine(configuration, path, 0))


@pytest.mark.parametrize("name", ROWS)
def test_columns_are_the_estimators_deviations_at_each_sample(name: str) -> None:
    configuration, plain = autopilot(name)
    _, watched = autopilot(name)
    recorded = watched.estimator = RecordedDeviation(watched.estimator, configuration)
    rows = []
    for _ in range(20):
        measurement = plain.machine.read()
        assert plain.estimator.update(measurement) == recorded.update(measurement)
        rows.append(plain.estimator.deviation)
        plain.estimator.prepare()
        recorded.prepare()
    first, first_row, second, second_row = ROWS[name]
    assert recorded.column(first).tolist() == [row[first_row] for row in rows]
    assert recorded.column(second).tolist() == [row[second_row] for row in rows]
    assert np.isnan(recorded.column("plough_depth")).all()
    assert recorded.times.feedback > 0.0


def test_an_ideal_estimator_has_none() -> None:
    configuration, ideal = autopilot("articulated-ideal")
    with pytest.raises(ConfigurationError, match="no standard deviation"):
        RecordedDeviation(ideal.estimator, configuration)


def test_a_run_keeps_them_and_is_the_same_run(short_task: Task, short_result) -> None:
    columns = ("deviation.tractor_yaw", "deviation.trailer_slip", "error.tractor")
    result = run_task(replace(short_task, columns=columns))
    assert result.metrics.error_m == short_result.metrics.error_m
    assert result.columns["error.tractor"].tolist() == short_result.columns["error.tractor"].tolist()
    yaw = result.columns["deviation.tractor_yaw"]
    assert len(yaw) == len(result.columns["error.tractor"])
    assert (yaw > 0.0).all()
    assert yaw[-1] < yaw[0]
    assert np.isnan(result.columns["deviation.trailer_slip"]).all()
