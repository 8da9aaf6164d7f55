"""Recorded lines where there are any, and what is said where there are none."""

import dataclasses
from pathlib import Path

import pytest

from drawbar.experiment.experiment import load_experiment
from drawbar.report.metrics import ErrorStatistics
from drawbar.report.path_errors import Bodies

NAME = "recorded-lines"
ROOT = Path(__file__).parents[3]


def test_a_row_has_means_and_what_making_the_line_drivable_cost(
    recorded_field, make_result, assemble, write_parts, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    experiment = load_experiment(ROOT / "experiments" / NAME)
    assert experiment.left_out == {}
    classes = {name: ErrorStatistics(mean=0.01, rms=0.01, max=0.1) for name in ("straight", "curve", "kink", "all")}
    result = make_result({}, error_m=Bodies(tractor=classes, trailer=classes))
    measured = assemble({case: [result] for case in experiment.configurations})
    _, tables = write_parts(dataclasses.replace(measured, experiment=experiment))
    rows = {row[0]: row[1:] for row in tables["lines"].rows}
    assert rows["Cu 275.4°"] == [*["1.0 / 1.0"] * 3, "10 / 10", "0.470 / 0.345"]


def test_without_the_field_nothing_is_driven(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "somewhere").mkdir()
    monkeypatch.chdir(tmp_path / "somewhere")
    experiment = load_experiment(ROOT / "experiments" / NAME)
    assert experiment.configurations == {}
    assert experiment.left_out["Cu 49.9°"] == "../shared/data/agopengps-field is not here"
