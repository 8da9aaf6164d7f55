"""The tables of experiments/faults."""

import runpy
from pathlib import Path

import pytest

from drawbar.experiment.declaration import Expectation

FOLDER = Path(__file__).parents[2] / "experiments" / "faults"


@pytest.mark.parametrize(
    ("expected", "told"),
    [
        (Expectation(at_most=0.0), "drives on"),
        (Expectation(at_most=3.0), "drives on, slower or stops"),
        (Expectation(at_least=3.0, at_most=4.0), "stops or releases"),
        (Expectation(value=6.0, within=0.001), "boards release"),
    ],
)
def test_the_table_names_every_response_that_is_expected(expected, told):
    assert runpy.run_path(str(FOLDER / "analysis.py"))["allowed"](expected) == told
