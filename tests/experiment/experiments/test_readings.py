"""The table of readings, and what its alterations change."""

import math
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from drawbar.report.metrics import ErrorStatistics
from drawbar.report.path_errors import Bodies
from drawbar.simulation import Simulation

NAME = "readings"
RESULTS = Path(__file__).parents[3] / "experiments" / NAME / "results.md"
CLASSES = ("straight", "0.1", "0.125", "0.15", "all")
SHIPPED = "paper: as shipped"


@pytest.fixture
def run(make_result):
    """Return a function that makes a run with the same distance of each body from the path everywhere, m."""

    def make(tractor: float, trailer: float, **metrics: object):
        bodies = [{name: ErrorStatistics(mean=d, rms=d, max=2.0 * d) for name in CLASSES} for d in (tractor, trailer)]
        yaw = Bodies(tractor=math.radians(10.0 * tractor), trailer=math.radians(10.0 * trailer))
        error = Bodies(tractor=bodies[0], trailer=bodies[1])
        return make_result({}, **({"error_m": error, "yaw_rmse_rad": yaw, "solver_failures": 2} | metrics))

    return make


def test_a_row_has_means_the_worst_seed_and_all_failures(experiment, run, assemble, write_parts) -> None:
    results = {case: [run(0.1, 0.2), run(0.3, 0.2)] for case in experiment.configurations}
    results[SHIPPED] = [run(0.1, 0.2), run(0.3, 0.2, finished=False)]
    _, tables = write_parts(assemble(results))
    rows = tables["readings"].rows
    assert rows[0] == [f"{SHIPPED} (1/2 finished)", *["20.0 / 20.0"] * 4, "60 / 40", "3.0 / 2.0", "4"]
    assert [row[0] for row in rows[1:]] == list(experiment.configurations)[1:]


def test_every_row_is_in_the_committed_results(experiment) -> None:
    text = RESULTS.read_text("utf-8")
    told = [case for case in experiment.configurations if f"| {case} |" in text or f"| {case} (" in text]
    assert told == list(experiment.configurations)


@pytest.fixture
def altered(experiment, build):
    """Return a function that builds a case."""

    def make(case: str) -> Simulation:
        simulation: Simulation = build("paper", "path.straight_length=1.0")
        for alteration in experiment.alterations[case]:
            alteration.apply(simulation)
        return simulation

    return make


def test_the_joint_sensor_turns_the_other_way(altered) -> None:
    for case, sense in ((SHIPPED, 1.0), ("paper: joint sensor reversed too", -1.0)):
        records = islice(altered(case).steps(), 60)
        pairs = [(each.measurement.trailer_steering, each.truth.trailer_steering) for each in records]
        measured, true = np.array(pairs).T
        assert np.abs(true).max() > math.radians(3.0)
        assert np.abs(measured - sense * true).max() < math.radians(2.0)


@pytest.mark.parametrize(
    ("case", "tractor", "trailer"),
    [
        (SHIPPED, 0.2, 0.0),
        ("paper: tractor reference constant", 0.0, 0.0),
        ("paper: N = 15, reference constant", 0.0, 0.0),
        ("paper: trailer reference advances", 0.2, 0.2),
    ],
)
def test_references_stay_or_advance(altered, case: str, tractor: float, trailer: float) -> None:
    simulation = altered(case)
    assert len(list(islice(simulation.steps(), 2))) == 2
    advance = simulation.autopilot.library.components["guidance"].settings.array("advance")
    assert advance == pytest.approx([tractor, trailer])
