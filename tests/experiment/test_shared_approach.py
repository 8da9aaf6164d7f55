"""Rehearsed runs that share the drive to their fault's place: each tells what it tells alone."""

import dataclasses
import sys
from pathlib import Path

import numpy as np
import pytest

from drawbar.experiment.alteration import Alteration
from drawbar.experiment.cluster import Failure
from drawbar.experiment.experiment import load_experiment
from drawbar.experiment.shared_approach import TOGETHER, grouped, run_tasks
from drawbar.experiment.task import Result, Task, run_task

FOLDER = Path("experiments/faults")
CASE = "3 m/s, straight"
FAULTS = ("no fault", "S1 positions are not numbers", "K2 bit errors in commands")
BROKEN = """
import os

def raises(trial):
    raise ValueError("no such fault")

def ends_the_process(trial):
    os._exit(3)

def is_nowhere(trial):
    trial.place = 1e6
    trial.rehearsal.now = 10**12

def prints(trial):
    print("nothing that matters")
"""

forked = pytest.mark.skipif(sys.platform != "linux", reason="a process is copied on Linux only")


@pytest.fixture(scope="module")
def tasks() -> list[Task]:
    """Runs of one drive with three faults, of which each column is kept."""
    experiment = load_experiment(FOLDER)
    return [experiment.tasks(1)[f"{CASE}: {fault}"][0] for fault in FAULTS]


@pytest.fixture(scope="module")
def together(tasks: list[Task]) -> list[Result | Failure]:
    faults = [Alteration(name=name, source=BROKEN) for name in ("raises", "ends_the_process", "prints")]
    return [*run_tasks([*tasks, *(dataclasses.replace(tasks[0], fault=fault) for fault in faults)])]


@forked
@pytest.mark.parametrize("number", range(len(FAULTS)))
def test_a_run_in_a_copy_tells_what_it_tells_alone(tasks, together, number: int) -> None:
    here, alone = together[number], run_task(tasks[number])
    assert here.source == alone.source
    for name in tasks[number].columns:
        np.testing.assert_array_equal(here.columns[name], alone.columns[name])


@forked
def test_a_run_that_raises_or_ends_its_process_disturbs_no_other(together) -> None:
    raised, ended, printed = together[len(FAULTS) :]
    assert raised == Failure(reason="ValueError: no such fault")
    assert ended == Failure(reason="the process of this run ended with 3")
    for name, column in printed.columns.items():
        np.testing.assert_array_equal(column, together[0].columns[name])


@forked
def test_all_runs_of_a_place_that_is_never_reached_say_so(tasks) -> None:
    nowhere = Alteration(name="is_nowhere", source=BROKEN)
    lost = [dataclasses.replace(each, alterations=(nowhere,)) for each in tasks[:2]]
    for outcome in run_tasks(lost):
        assert isinstance(outcome, Failure)
        assert "1000000.0 m was not reached" in outcome.reason


def test_runs_that_differ_in_their_fault_alone_are_grouped(tasks, short_task: Task) -> None:
    other = [dataclasses.replace(each, seed=1) for each in tasks]
    plain = [dataclasses.replace(short_task, seed=seed) for seed in range(2)]
    groups = [*grouped([*tasks, *other, *plain]).values()]
    assert sorted(len(each) for each in groups) == ([1, 1, 3, 3] if sys.platform == "linux" else [1] * 8)
    assert {task.key for group in groups for task in group} == {task.key for task in (*tasks, *other, *plain)}


@forked
def test_groups_are_small_enough_for_progress_to_move(tasks) -> None:
    many = [dataclasses.replace(tasks[0], fault=Alteration(name="prints", source=str(k))) for k in range(TOGETHER + 1)]
    assert [len(each) for each in grouped(many).values()] == [TOGETHER, 1]
