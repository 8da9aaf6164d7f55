"""Alterations: found by name, sent to workers as text, told apart by a task's key."""

import dataclasses
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from distributed import Client

from drawbar.errors import ConfigurationError
from drawbar.experiment.alteration import Alteration, InterceptedMachine, find_alteration
from drawbar.experiment.cluster import call_all
from drawbar.experiment.experiment import Experiment
from drawbar.experiment.task import Result, Task, run_task
from drawbar.simulation import Simulation

Write = Callable[[str], Experiment]
SLOWER = """
from drawbar.simulation import Simulation

FACTOR = 0.5


def slower(simulation: Simulation) -> None:
    _set(simulation, FACTOR)


def faster(simulation: Simulation) -> None:
    _set(simulation, 1.0 / FACTOR)


def _set(simulation, factor):
    simulation.autopilot.set_speed(factor * simulation.configuration.speed)
"""
CASES = 'title = "x"\ncases = [{ name = "articulated", alteration = "slower" }, { name = "paper" }]'


@pytest.fixture
def write_altered(write_experiment: Write, tmp_path: Path) -> Callable[[str, str], Experiment]:
    """Return a function that makes an experiment of experiment.toml and alterations.py."""

    def write(text: str, alterations: str = SLOWER) -> Experiment:
        (tmp_path / "small").mkdir(exist_ok=True)
        (tmp_path / "small" / "alterations.py").write_text(alterations, "utf-8")
        return write_experiment(text)

    return write


def test_a_task_carries_the_alterations_of_its_case_and_variant(write_altered) -> None:
    variants = '\nvariants = [{ name = "a", alteration = "faster" }, { name = "b" }]'
    tasks = write_altered(CASES + variants).tasks(1)
    names = {case: [each.name for each in task.alterations] for case, (task,) in tasks.items()}
    assert names == {
        "articulated: a": ["slower", "faster"],
        "articulated: b": ["slower"],
        "paper: a": ["faster"],
        "paper: b": [],
    }
    assert tasks["paper: a"][0].alterations[0].source == SLOWER


def test_a_key_tells_alterations_apart(short_task: Task) -> None:
    alterations = [(), *((Alteration(name=name, source=source),) for name in ("a", "b") for source in ("x", "y"))]
    assert len({dataclasses.replace(short_task, alterations=each).key for each in alterations}) == 5


def test_an_altered_run_is_driven_by_any_worker(cluster: Client, short_task: Task, short_result: Result) -> None:
    altered = dataclasses.replace(short_task, alterations=(Alteration(name="slower", source=SLOWER),))
    ((_, result),) = call_all(cluster, run_task, {altered.key: altered})
    assert result.metrics.finished
    assert result.metrics.duration_s > 1.5 * short_result.metrics.duration_s
    assert result.metrics.error_m == run_task(altered).metrics.error_m


@pytest.mark.parametrize(
    ("name", "alterations", "told"),
    [
        ("slowest", SLOWER, "no function 'slowest'; it has: slower, faster"),
        ("_set", SLOWER, "no function '_set'"),
        ("slower", "", "it has: none"),
        ("slower", "def slower(:", "cannot be read"),
    ],
)
def test_what_cannot_be_applied_is_reported(write_altered, name: str, alterations: str, told: str) -> None:
    with pytest.raises(ConfigurationError, match=r"alterations\.py") as error:
        write_altered(CASES.replace("slower", name), alterations)
    assert told in str(error.value)


def test_a_folder_of_alterations_is_searched(tmp_path: Path) -> None:
    (tmp_path / "alterations").mkdir()
    (tmp_path / "alterations" / "speeds.py").write_text(SLOWER, "utf-8")
    (tmp_path / "alterations" / "nothing.py").write_text("def nothing(simulation):\n    pass\n", "utf-8")
    assert find_alteration(tmp_path, "faster").source == SLOWER
    with pytest.raises(ConfigurationError, match="alterations: has no function 'slowest'; it has: nothing, slower, f"):
        find_alteration(tmp_path, "slowest")
    (tmp_path / "alterations" / "nothing.py").write_text("def faster(simulation):\n    pass\n", "utf-8")
    with pytest.raises(ConfigurationError, match="alterations: 2 files have a function 'faster'; rename one"):
        find_alteration(tmp_path, "faster")


def test_a_missing_file_is_reported(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"alterations\.py: alteration 'slower' cannot be read"):
        find_alteration(tmp_path, "slower")


def test_a_machine_that_is_only_looked_at_makes_the_same_run(build: Callable[..., Simulation]) -> None:
    def drive(simulation: Simulation) -> list[float]:
        return [record.command.tractor_steering for record, _ in zip(simulation.steps(), range(50), strict=False)]

    watched, seen = build("articulated", "path.radii=[5.0]"), []
    watched.machine = InterceptedMachine(watched.machine, lambda measurement: seen.append(measurement) or measurement)
    assert np.array_equal(drive(watched), drive(build("articulated", "path.radii=[5.0]")))
    assert [measurement.time for measurement in seen[:3]] == pytest.approx([0.0, 0.2, 0.4])


def test_the_true_state_is_known_of_a_machine_that_is_only_looked_at(build: Callable[..., Simulation]) -> None:
    watched = build("articulated-ideal", "path.radii=[5.0]")
    watched.machine = InterceptedMachine(watched.machine, lambda measurement: measurement)
    assert [record.estimate.creep for record, _ in zip(watched.steps(), range(3), strict=False)] == [0.0, 0.0, 0.0]
