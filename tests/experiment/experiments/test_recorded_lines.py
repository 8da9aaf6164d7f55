"""Recorded lines: those of the repository always, those beside it where they are."""

import math
from pathlib import Path

import pytest

from drawbar.experiment.experiment import load_experiment
from drawbar.report.metrics import ErrorStatistics
from drawbar.report.path_errors import Bodies

NAME = "recorded-lines"
ROOT = Path(__file__).parents[3]


def test_a_row_has_means_and_what_making_the_line_drivable_cost(
    make_result, assemble, write_parts, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    error = ErrorStatistics(mean=0.01, rms=0.01, max=0.1, deviation=0.02, p95=0.03)
    classes = dict.fromkeys(("straight", "curve", "kink", "all"), error)
    calm = classes | {"kink": ErrorStatistics(mean=math.nan, rms=math.nan, max=math.nan)}
    results = {
        name: [make_result({}, error_m=Bodies(tractor=each, trailer=each))] * 2
        for name, each in (("Cu 14.1°", classes), ("Cu 85.2°", calm))
    }
    _, tables = write_parts(assemble(results))
    rows = {row[0]: row[1:] for row in tables["lines"].rows}
    whole = ["2.0 / 2.0", "3.0 / 3.0", "10 / 10"]
    assert rows["Cu 14.1°"][:6] == [*["1.0 / 1.0"] * 3, *whole]
    assert rows["Cu 85.2°"][:6] == ["1.0 / 1.0", "1.0 / 1.0", "–", *whole]
    loose, tight = map(float, rows["Cu 14.1°"][6].split(" / "))
    assert 0.1 < tight < loose < 1.0


def test_lines_that_are_not_there_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    experiment = load_experiment(ROOT / "experiments" / NAME)
    assert list(experiment.configurations) == ["Cu 14.1°", "Cu 85.2°"]
    assert experiment.left_out["Cu 49.9°"] == "../shared/data/agopengps-field is not here"
    assert len(experiment.left_out) == 3
