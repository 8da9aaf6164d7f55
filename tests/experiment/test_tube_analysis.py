"""The figures of experiments/tube from one of its runs, as it is and doctored."""

import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drawbar.experiment.experiment import load_experiment
from drawbar.experiment.task import run_task

FOLDER = Path(__file__).parents[2] / "experiments" / "tube"


@pytest.fixture(scope="module")
def figures():
    return runpy.run_path(str(FOLDER / "analysis.py"))["figures"]


@pytest.fixture(scope="module")
def result():
    return run_task(load_experiment(FOLDER).tasks(1)["predicted: vertices"][0])


def doctored(result, **changes):
    """Return the result with numbers added to columns in one sample, by names with __ for dots."""
    columns = dict(result.columns)
    for name, change in changes.items():
        key = name.replace("__", ".")
        columns[key] = columns[key] + np.eye(1, len(columns[key]), 50)[0] * change
    return replace(result, columns=columns)


def test_a_run_within_its_declaration_is_in_its_tube_and_within_its_bounds(figures, result):
    found = figures(result)
    assert (found["inside"], found["over"], found["unforeseen"]) == (100.0, 0.0, 0.0)
    assert 0.0 < found["margin"] < 0.1
    assert not any(
        found[f"{body} {bound}"] for body in ("tractor", "trailer") for bound in ("command", "angle", "rate")
    )


def test_one_sample_outside_is_found(figures, result):
    samples = 2 * len(result.columns["measurement.time"])
    assert figures(doctored(result, plan__tractor__deviation__0=0.1))["inside"] == pytest.approx(
        100.0 - 100.0 / samples
    )
    assert figures(doctored(result, plan__trailer__deviation__1=0.1))["inside"] == pytest.approx(
        100.0 - 100.0 / samples
    )
    # what the estimate errs by is not the vehicle's error
    both = doctored(result, plan__tractor__deviation__1=0.1, estimate__tractor__yaw=0.1, estimate__trailer__yaw=0.1)
    assert figures(both)["inside"] == 100.0


def test_a_bound_exceeded_is_unforeseen_unless_the_margin_was_negative(figures, result):
    asked = doctored(result, trailer_steering__nominal=1.0)
    assert figures(asked)["trailer command"] == pytest.approx(100.0 / len(result.columns["measurement.time"]))
    assert figures(asked)["unforeseen"] == 1.0
    assert figures(doctored(asked, trailer_steering__margin=-2.0))["unforeseen"] == 0.0
    assert figures(doctored(asked, tractor_steering__margin=-2.0))["unforeseen"] == 1.0
    assert figures(doctored(result, truth__tractor_steering=1.0))["tractor angle"] > 0.0
