"""The shipped experiments with results made by hand: no run is driven."""

import dataclasses
import importlib.util
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

from drawbar.experiment.analysis import error_figures
from drawbar.experiment.elements import Table
from drawbar.experiment.experiment import Experiment, load_experiment
from drawbar.experiment.measure import Runs
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result
from drawbar.geometry import Floats

FOLDER = Path(__file__).parents[3] / "experiments"
load = cache(load_experiment)


@pytest.fixture
def analysis(request: pytest.FixtureRequest) -> ModuleType:
    """Return the analysis.py of the experiment that the test's module names."""
    spec = importlib.util.spec_from_file_location("analysis", FOLDER / request.module.NAME / "analysis.py")
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def experiment(request: pytest.FixtureRequest) -> Experiment:
    return load(FOLDER / request.module.NAME)


@pytest.fixture
def make_result(short_result: Result) -> Callable[..., Result]:
    """Return a function that makes a result of columns, and of metrics where they are not those of some run."""

    def make(columns: Mapping[str, Floats], **metrics: object) -> Result:
        return dataclasses.replace(
            short_result, columns=columns, metrics=dataclasses.replace(short_result.metrics, **metrics)
        )

    return make


@pytest.fixture
def assemble(
    analysis: ModuleType, experiment: Experiment
) -> Callable[[Mapping[str, Sequence[Result]]], MeasuredExperiment]:
    """Return a function that makes a measured experiment of the results of every case."""

    figures = getattr(analysis, "figures", lambda result: error_figures(result.metrics))

    def measured_of(results: Mapping[str, Sequence[Result]]) -> MeasuredExperiment:
        return MeasuredExperiment(
            experiment=experiment,
            seeds=len(next(iter(results.values()))),
            runs={case: Runs(results=each, failures=[]) for case, each in results.items()},
            figures={case: [figures(result) for result in each] for case, each in results.items()},
        )

    return measured_of


@pytest.fixture
def write_parts(analysis: ModuleType, tmp_path: Path) -> Callable[[MeasuredExperiment], tuple[str, dict[str, Table]]]:
    """Return a function that writes all elements of a report, and returns its Markdown and its tables."""

    def write(measured: MeasuredExperiment) -> tuple[str, dict[str, Table]]:
        elements = list(analysis.report(measured))
        for element in elements:
            element.write(tmp_path)
        text = "\n\n".join(element.markdown() for element in elements)
        return text, {element.name: element for element in elements if isinstance(element, Table)}

    return write
