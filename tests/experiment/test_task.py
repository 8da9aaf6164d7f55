"""One run as plain data: the figures of `drawbar run`, exact after a way through bytes."""

import dataclasses
import subprocess
import sys
from pathlib import Path

import msgspec
import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.experiment.task import (
    Result,
    Task,
    controller_source,
    decode_result,
    encode_result,
    run_task,
    solver_sections,
    source_digest,
)


def test_figures_are_those_of_the_same_run(simulate, short_task: Task, short_result: Result) -> None:
    loss = "machine.events=[{kind='gps_loss', start=5.0, duration=1.0}]"
    run = simulate("articulated", "path.radii=[5.0]", "path.straight_length=1.0", loss, seed=1)
    error = run.true_errors("tractor").error
    assert short_result.metrics.finished
    assert short_result.metrics.error_m.tractor["all"].mean == pytest.approx(np.abs(error).mean(), rel=1e-12)
    assert np.array_equal(short_result.columns["error.tractor"], error)
    assert np.array_equal(short_result.columns["progress.trailer"], run.true_errors("trailer").progress)
    assert np.array_equal(short_result.columns["measurement.time"], run.column("measurement", "time"))


def test_a_result_survives_the_way_through_bytes(short_result: Result) -> None:
    again = decode_result(encode_result(short_result))
    assert repr(again.metrics) == repr(short_result.metrics)  # NaN is NaN
    assert np.isnan(again.columns["measurement.tractor_x"]).any()
    for name, column in short_result.columns.items():
        assert np.array_equal(again.columns[name], column, equal_nan=True)


@pytest.mark.parametrize("keep", [0, 1, 100])
def test_damaged_bytes_are_refused(short_result: Result, keep: int) -> None:
    with pytest.raises(msgspec.MsgspecError):
        decode_result(encode_result(short_result)[:keep])


def test_a_run_that_is_given_up_is_a_result() -> None:
    blind = "machine.events=[{kind='gps_loss', start=2.0, duration=60.0}]"
    configuration = load_configuration("articulated", ("path.radii=[5.0]", blind)).to_toml()
    result = run_task(Task(configuration=configuration, seed=0, columns=("error.tractor",)))
    assert not result.metrics.finished
    assert "neither antenna had had a valid fix for" in result.metrics.outcome
    assert len(result.columns["error.tractor"]) > 50


def test_a_key_tells_everything_apart_that_changes_a_result(short_task: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    changes = ({"seed": 2}, {"columns": ("error.tractor",)}, {"configuration": short_task.configuration + "\n"})
    keys = {dataclasses.replace(short_task, **change).key for change in ({}, *changes)}
    monkeypatch.setattr("drawbar.experiment.task.source_digest", lambda: "another drawbar")
    assert len(keys | {short_task.key}) == 5
    assert dataclasses.replace(short_task).key == short_task.key


def test_a_run_is_driven_again_once_the_users_own_controller_was_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    changes = ["controller.model=steers_so:Mine"]
    task = Task(configuration=load_configuration("articulated", changes).to_toml(), seed=0)

    def key() -> str:
        controller_source.cache_clear()
        return task.key

    keys = {key()}  # without the module
    for file, text in (("steers_so.py", "GAIN = 1.0"), ("steers_so.py", "GAIN = 2.0"), ("its_helper.py", "X = 1")):
        (tmp_path / file).write_text(text, "utf-8")
        keys.add(key())
    assert len(keys) == 4
    assert key() in keys


def test_every_result_says_which_code_measured_it(short_result: Result) -> None:
    assert short_result.source == source_digest()


def test_solvers_do_not_depend_on_path_start_and_machine() -> None:
    changes = ("path.radii=[5.0]", "start.left=1.0", "machine.sensors.position=0.1", "name=x")
    plain, other = (load_configuration("articulated", change).to_toml() for change in ((), changes))
    assert solver_sections(plain) == solver_sections(other)
    longer = load_configuration("articulated", ("controller.horizon=16",)).to_toml()
    assert solver_sections(longer) != solver_sections(plain)


def test_a_worker_of_plain_runs_loads_nothing_of_rehearsals_or_peers() -> None:
    # every worker imports this before its first run
    others = {"drawbar.driving.stand_in.rehearsal", "drawbar.benchmark.peers.race", "scipy", "matplotlib"}
    program = f"import sys, drawbar.experiment.task; print(*({others} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
