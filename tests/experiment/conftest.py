"""A small experiment on a short path, and one local cluster for the whole session."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import dask
import pytest
from distributed import Client
from rich.console import Console

from drawbar.config import load_configuration
from drawbar.experiment.cluster import open_cluster
from drawbar.experiment.experiment import Experiment, load_experiment
from drawbar.experiment.progress import RunsProgress
from drawbar.experiment.task import Result, Task, run_task

SHORT = ("path.radii=[5.0]", "path.straight_length=1.0")
TWO_CASES = """
title = "Two controllers"
seeds = 3
columns = ["error.tractor"]
changes = ["path.radii=[5.0]", "path.straight_length=1.0"]
cases = [{ name = "articulated" }, { name = "slow", configuration = "articulated", changes = ["speed=0.8"] }]
"""


@pytest.fixture
def two_cases() -> str:
    """Return an experiment.toml: two cases, three seeds, a short path."""
    return TWO_CASES


@pytest.fixture(scope="session")
def cluster() -> Iterator[Client]:
    # a worker's death fails its call at once: Dask may leave workers that die in quick succession dead
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}), open_cluster(jobs=2) as client:
        yield client


@pytest.fixture
def room() -> Callable[[int], AbstractContextManager[None]]:
    """Return what lets no file grow beyond so many bytes in a context, as on a disk that becomes full."""
    resource = pytest.importorskip("resource", reason="Windows knows no such limit")

    @contextmanager
    def limited(size: int) -> Iterator[None]:
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
        try:
            yield
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))

    return limited


@pytest.fixture
def progress() -> Iterator[RunsProgress]:
    with RunsProgress(Console(quiet=True), "test") as progress:
        yield progress


@pytest.fixture
def write_experiment(tmp_path: Path) -> Callable[[str], Experiment]:
    """Return a function that makes an experiment of the text of an experiment.toml."""

    def write(text: str) -> Experiment:
        folder = tmp_path / "small"
        folder.mkdir(exist_ok=True)
        (folder / "experiment.toml").write_text(text, "utf-8")
        return load_experiment(folder)

    return write


@pytest.fixture(scope="session")
def short_task() -> Task:
    columns = ("error.tractor", "progress.trailer", "measurement.time", "measurement.tractor_x")
    loss = "machine.events=[{kind='gps_loss', start=5.0, duration=1.0}]"
    configuration = load_configuration("articulated", (*SHORT, loss)).to_toml()
    return Task(configuration=configuration, seed=1, columns=columns)


@pytest.fixture(scope="session")
def short_result(short_task: Task) -> Result:
    return run_task(short_task)
