"""Whole runs through the library, driven once per session and shared by the tests that look at them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path as FilePath

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.geometry import Floats
from drawbar.guidance.path import Path
from drawbar.report.path_errors import PathErrors, project_track
from drawbar.signals import StepRecord
from drawbar.simulation import Simulation

FIELD = FilePath(__file__).parents[2] / "shared" / "data" / "agopengps-field"


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


@pytest.fixture(scope="session")
def recorded_field() -> FilePath:
    """Return the real AgOpenGPS field that lies beside the repository."""
    if not FIELD.is_dir():
        pytest.skip("the recorded field ../shared/data/agopengps-field is not here")
    return FIELD
