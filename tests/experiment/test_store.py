"""Finished results on disk: whole, never stale."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import pytest

from drawbar.errors import DrawbarError, StorageError
from drawbar.experiment.store import ResultStore
from drawbar.experiment.task import Result, Task


def test_a_result_is_found_again_by_its_task_alone(tmp_path: Path, short_task: Task, short_result: Result) -> None:
    ResultStore(tmp_path).put(short_task, short_result)
    again = ResultStore(tmp_path)
    found = again.get(short_task)
    assert found is not None
    assert repr(found.metrics) == repr(short_result.metrics)  # NaN is NaN
    assert again.get(Task(configuration=short_task.configuration, seed=7)) is None


def test_a_damaged_file_is_no_result(tmp_path: Path, short_task: Task, short_result: Result) -> None:
    store = ResultStore(tmp_path)
    store.put(short_task, short_result)
    (file,) = tmp_path.glob("*/*")
    file.write_bytes(file.read_bytes()[:100])
    assert store.get(short_task) is None


def test_results_of_other_code_are_forgotten(
    tmp_path: Path, short_task: Task, short_result: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    ResultStore(tmp_path).put(short_task, short_result)
    monkeypatch.setattr("drawbar.experiment.store.source_digest", lambda: "another")
    assert ResultStore(tmp_path).get(short_task) is None
    assert [folder.name for folder in tmp_path.iterdir()] == ["another"]


def test_a_result_that_cannot_be_kept_is_reported_with_its_file_and_the_cause(
    tmp_path: Path, short_task: Task, short_result: Result, room: Callable[[int], AbstractContextManager[None]]
) -> None:
    store = ResultStore(tmp_path)
    with room(100), pytest.raises(StorageError, match=r"msgpack: cannot be written \(.+\); free space"):
        store.put(short_task, short_result)
    assert not list(tmp_path.glob("*/*"))
    store.put(short_task, short_result)
    assert store.get(short_task) is not None


def test_a_folder_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    (tmp_path / "runs").touch()
    with pytest.raises(DrawbarError, match="runs: results cannot be kept there"):
        ResultStore(tmp_path / "runs")
