"""Medians, tables and ratios of made-up times."""

from types import SimpleNamespace

import numpy as np
import pytest

NAME = "execution-times"
MICRO = 1e-6
SOLVERS = {
    "paper": (1.0, 2.0),
    "articulated": (1.0, 2.0),
    "paper-centralised": (8.0,),
    "articulated-centralised": (5.0,),
}


@pytest.fixture
def run(make_result):
    """Return a function that makes a run from the overall times of its solvers, µs, a third of each in feedback."""

    def make(tractor, trailer=np.nan, estimator=9.0):
        columns = {}
        for solver, overall in (("tractor", tractor), ("trailer", trailer), ("estimator", estimator)):
            times = np.full(200, overall * MICRO)
            times[:30] = 1.0  # the window still fills
            times[40] *= 1000.0  # interrupted
            columns[f"{solver}_times.prepare"], columns[f"{solver}_times.feedback"] = 2.0 / 3.0 * times, times / 3.0
        return make_result(columns)

    return make


@pytest.fixture
def by_themselves(analysis, monkeypatch: pytest.MonkeyPatch):
    """Let the solvers by themselves take made-up times, in s, with one more sample before and after."""

    def probed_runs(name, horizons, steps, *, with_peers):
        names = [name] if name.endswith("centralised") else [f"{name}-tractor", f"{name}-trailer"]
        count = horizons[0] + 1 + steps
        return [
            [
                SimpleNamespace(
                    name=solver,
                    prepare=[1.0] * (horizons[0] + 1) + [0.75 * overall * MICRO] * (steps - 1) + [0.0],
                    feedback=[0.25 * overall * MICRO] * count,
                )
                for solver, overall in zip(names, SOLVERS[name], strict=True)
            ]
        ]

    monkeypatch.setattr(analysis, "probed_runs", probed_runs)


def test_figures_are_medians_of_what_follows_the_start(analysis, run) -> None:
    figures = analysis.figures(run(3.0))
    assert figures["tractor overall"] == pytest.approx(3.0)
    assert figures["tractor preparation"] == pytest.approx(2.0)
    assert figures["estimator feedback"] == pytest.approx(3.0)
    assert np.isnan(figures["trailer overall"])


@pytest.mark.usefixtures("by_themselves")
def test_tables_hold_the_times_and_the_text_judges_their_ratios(run, assemble, write_parts) -> None:
    results = {"paper": [run(3.0, 3.0)] * 2, "articulated": [run(1.0, 1.0)] * 2}
    results |= {f"{case}-centralised": [run(10.0)] * 2 for case in ("paper", "articulated")}
    text, tables = write_parts(assemble(results))
    rows = {tuple(row[:3]): row[3:] for row in tables["times"].rows}
    assert rows["the paper", "centralised", "overall"] == ["6598.3", "6797.7", "7240.0"]
    assert rows["paper", "trailer", "preparation"] == ["1.50"] * 3
    assert rows["articulated-centralised", "centralised", "overall"] == ["5.00"] * 3
    assert "the paper's table, averages: 37 %: both statements hold" in text
    assert "`paper` per `paper-centralised`, by themselves, averages: 38 %: both statements hold" in text
    assert "`articulated` per `articulated-centralised`, by themselves, averages: 60 %: only the weaker" in text
    assert "the same in the loop, medians, over the seeds: 60 ± 0 %: only the weaker statement holds" in text
    loop = {tuple(row[:3]): row[3:] for row in tables["loop"].rows}
    assert loop["paper", "estimator", "overall"] == ["9.00", "61.89", "9000.00", "9.00", "9.00"]
    assert ("paper-centralised", "centralised", "overall") in loop


def test_neither_statement_holds_at_three_quarters(analysis) -> None:
    assert [analysis._holds(percent)[:4] for percent in (49.9, 50.0, 74.9, 75.0)] == ["both", "only", "only", "neit"]
