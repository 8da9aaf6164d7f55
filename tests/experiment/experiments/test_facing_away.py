"""Random starts that face away, and what becomes of them."""

import math
from itertools import islice

import numpy as np
import pytest

from drawbar.experiment.task import run_task

NAME = "facing-away"
TIME = 0.2 * np.arange(301)


@pytest.fixture
def run(make_result):
    """Return a function that makes a run whose bodies are 1 m beside the path for some time, s."""

    def make(seconds: float, *, finished: bool = True, steps: int = len(TIME)):
        error = np.where(seconds > TIME, -1.0, 0.1)[:steps]
        columns = {"measurement.time": TIME[:steps], "error.tractor": error, "error.trailer": error}
        return make_result(columns, finished=finished)

    return make


def test_no_way_a_run_lost_later_and_one_that_comes_there(analysis, run) -> None:
    figures = [
        analysis.figures(each) for each in (run(9.0, finished=False, steps=1), run(9.0, finished=False), run(9.0))
    ]
    assert [each["without a way"] for each in figures] == [100.0, 0.0, 0.0]
    assert [each["lost later"] for each in figures] == [0.0, 100.0, 0.0]
    assert figures[2]["on the path after"] == pytest.approx(9.0)
    assert math.isnan(figures[0]["on the path after"])
    assert math.isnan(analysis.figures(run(99.0))["on the path after"])


def test_times_are_of_those_that_come_there(analysis, run, assemble, write_parts) -> None:
    results = [run(9.0, finished=False, steps=1), run(8.0), run(10.0), run(12.0)]
    _, tables = write_parts(assemble({"beside a straight": results, "beside a curve": results[:1] * 4}))
    straight, curve = tables["facing-away"].rows
    assert straight[:2] == ["beside a straight", "4"]
    assert straight[2].startswith("25.0 ± ")
    assert straight[3:] == ["0.0 ± 0.0", "10", "12"]
    assert curve[2:] == ["100.0 ± 0.0", "0.0 ± 0.0", "–", "–"]


@pytest.mark.parametrize(("case", "classes"), [("straight", {"straight"}), ("curve", {"0.1", "0.125", "0.15"})])
def test_starts_are_beside_their_part_of_the_path_and_face_away(experiment, build, case: str, classes) -> None:
    (alteration,) = experiment.alterations[f"beside a {case}"]
    found = []
    for seed in (0, 1, 2, 0):
        simulation = build("articulated", seed=seed)
        alteration.apply(simulation)
        pose = simulation.machine.truth().tractor
        _, x, y, yaw = simulation.path.nodes[0]
        assert math.hypot(pose.x - x, pose.y - y) <= 3.0
        assert math.radians(60.0) <= abs(math.remainder(pose.yaw - yaw, math.tau)) <= math.pi
        assert simulation.path.length == pytest.approx(60.0, abs=0.25)
        assert set(simulation.path.labels(np.zeros(1))) <= classes
        assert np.diff(simulation.path.nodes[:, 0]).min() > 0.0
        found.append((pose.x, pose.y, pose.yaw))
    assert found[0] == found[3]
    assert len(set(found)) == 3


def test_a_run_may_find_no_way(experiment, analysis) -> None:
    outcomes = [analysis.figures(run_task(task)) for task in experiment.tasks(6)["beside a curve"]]
    assert {each["without a way"] for each in outcomes} == {0.0, 100.0}
    assert any(each["on the path after"] > 10.0 for each in outcomes)


@pytest.mark.parametrize("seed", [0, 10, 20, 23])
def test_a_start_whose_plans_are_at_their_bounds_throughout_is_solved(experiment, build, seed: int) -> None:
    """The trailer's cost alone would have its steering a hundred times further than it goes."""
    (alteration,) = experiment.alterations["beside a curve"]
    simulation = build("articulated", seed=seed)
    alteration.apply(simulation)
    records = list(islice(simulation.steps(), 100))
    assert sum(record.solver_failures for record in records) == 0
    assert max(abs(record.command.trailer_steering) for record in records) > 0.3
