"""Whole runs through the library, driven once per session and shared by the tests that look at them."""

import signal
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path as FilePath

import numpy as np
import pytest
from short_run import Drawbar

from drawbar.cli import main as cli
from drawbar.config import load_configuration
from drawbar.geometry import Floats
from drawbar.guidance.path import Path
from drawbar.report.path_errors import PathErrors, project_track
from drawbar.signals import StepRecord
from drawbar.simulation import Simulation

ROOT = FilePath(__file__).parents[1]
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job would start everything deaf to it


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """Give each worker a row of whole files, whose fixtures are made once; whoever is done takes over from others."""
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log)  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """An AgOpenGPS field and its curves."""

    folder: FilePath
    curves: tuple[str, ...]


FIELDS = {
    "examples/field": Field(folder=ROOT / "examples" / "field", curves=("Cu 14.1°", "Cu 85.2°")),
    "../shared/data/agopengps-field": Field(
        folder=ROOT.parent / "shared" / "data" / "agopengps-field", curves=("Cu 275.4°", "Cu 49.9°", "Cu 183.7°")
    ),
}
"""the one that examples/record_field.py drove, and a real one, which only some machines have beside the repository"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    path: Path
    records: list[StepRecord]

    def column(self, *names: str) -> Floats:
        """Return one number of every step, named by the fields that lead to it."""
        values: list[object] = list(self.records)
        for name in names:
            values = [getattr(value, name) for value in values]
        return np.array(values, dtype=float)

    def true_errors(self, body: str) -> PathErrors:
        start = float(self.column("reference", body, "progress")[0])
        return project_track(self.path, self.column("truth", body, "x"), self.column("truth", body, "y"), start)


@pytest.fixture
def at_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the text that a command gets as its standard input be what a person types."""
    monkeypatch.setattr("drawbar.cli.options.is_asked", lambda: True)


@pytest.fixture
def drawbar(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Drawbar:
    """Return a function that runs the command line in this process: exit code, and what it said."""

    def drawbar(*arguments: str) -> tuple[int, str]:
        monkeypatch.setattr(sys, "argv", ["drawbar", *arguments])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        captured = capsys.readouterr()
        return int(ended.value.code or 0), captured.out + captured.err

    return drawbar


@pytest.fixture(scope="session")
def build() -> Callable[..., Simulation]:
    """Return a function that makes a run on the simulated machine from a shipped name and changes."""

    def build(name: str, *changes: str, seed: int = 0) -> Simulation:
        return Simulation(load_configuration(name, changes), seed)

    return build


@pytest.fixture(scope="session")
def simulate(build: Callable[..., Simulation]) -> Callable[..., Run]:
    """Return a function that drives a shipped configuration with changes to the end of its path."""

    @cache
    def simulate(name: str, *changes: str, seed: int = 0) -> Run:
        with build(name, *changes, seed=seed) as simulation:
            return Run(path=simulation.path, records=list(simulation.steps()))

    return simulate


@pytest.fixture(scope="session", params=FIELDS)
def recorded_field(request: pytest.FixtureRequest) -> Field:
    """Return each of the recorded fields."""
    return _present(request.param)


CURVES = [(name, curve) for name, field in FIELDS.items() for curve in field.curves]


@pytest.fixture(scope="session", params=CURVES, ids=" ".join)
def recorded_line(request: pytest.FixtureRequest) -> tuple[FilePath, str]:
    """Return each curve of the recorded fields: the folder of its field, and its name."""
    name, curve = request.param
    return _present(name).folder, curve


def _present(name: str) -> Field:
    if not FIELDS[name].folder.is_dir():
        pytest.skip(f"the recorded field {name} is not on this machine")
    return FIELDS[name]
