"""The table of slopes, and the estimator that somebody tells of one."""

import numpy as np
import pytest

NAME = "slopes"
TOLD = "told when the slope begins"


def test_every_estimator_has_a_row_and_every_event_a_column(experiment, short_result, assemble, write_parts) -> None:
    _, tables = write_parts(assemble({case: [short_result] * 2 for case in experiment.configurations}))
    table = tables["slopes"]
    assert list(table.header[1:]) == ["side slope, 3° of crab", "GPS lost for 10 s", "no event"]
    assert len(table.rows) == 7
    errors = short_result.metrics.error_m
    largest = f"{100.0 * errors.tractor['all'].max:.1f} / {100.0 * errors.trailer['all'].max:.1f}"
    assert table.rows[5] == [TOLD, *[largest] * 3]


def test_the_common_drift_is_large_only_while_the_slope_begins(experiment, build) -> None:
    simulation = build("articulated", "path.radii=[5.0]", "path.straight_length=1.0")
    (alteration,) = experiment.alterations[f"{TOLD}: no event"]
    alteration.apply(simulation)
    estimator = simulation.autopilot.library.components["estimator"]
    shipped, common = estimator.settings.array("common"), estimator.live.array("common")
    drifts = {round(record.measurement.time, 1): common.copy() for record in simulation.steps()}
    told = [time for time, drift in drifts.items() if not np.array_equal(drift, shipped)]
    assert told == pytest.approx(np.arange(25.0, 26.5, 0.2))
    assert drifts[25.0].max() == pytest.approx(0.05)
    assert drifts[25.0] / drifts[25.0].max() == pytest.approx(shipped / shipped.max())
