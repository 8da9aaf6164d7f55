"""The standard deviations kept beside a run are those that the estimator had at each sample."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.estimation.deviation import newest_deviation
from drawbar.experiment.deviation import RecordedDeviation
from drawbar.experiment.task import Task, run_task
from drawbar.simulation import Simulation

SHORT = ("path.radii=[5.0]", "path.straight_length=1.0")
ROWS = {"articulated": ("tractor_yaw", 2, "tractor_slip", 7), "paper-ekf": ("tractor_yaw", 2, "trailer_slip", 8)}


def simulation(name: str) -> Simulation:
    return Simulation(load_configuration(name, SHORT))


@pytest.mark.parametrize("name", ROWS)
def test_columns_are_the_estimators_deviations_at_each_sample(name: str) -> None:
    run = simulation(name)
    recorded = RecordedDeviation(run.autopilot, run.configuration)
    estimator, rows = run.autopilot.library.components["estimator"].live, []

    def between() -> None:
        recorded.keep()
        if name == "articulated":
            rows.append(newest_deviation(estimator))
        else:
            root = estimator.array("filter.R").T
            rows.append(np.sqrt(np.diag(root @ root.T)))

    for _ in islice(run.steps(between), 20):
        pass
    first, first_row, second, second_row = ROWS[name]
    np.testing.assert_allclose(recorded.column(first), [row[first_row] for row in rows], rtol=1e-12)
    np.testing.assert_allclose(recorded.column(second), [row[second_row] for row in rows], rtol=1e-12)
    assert np.isnan(recorded.column("plough_depth")).all()


def test_an_ideal_estimator_has_none() -> None:
    ideal = simulation("articulated-ideal")
    with pytest.raises(ConfigurationError, match="no standard deviation"):
        RecordedDeviation(ideal.autopilot, ideal.configuration)


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
