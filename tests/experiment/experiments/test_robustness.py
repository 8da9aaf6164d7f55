"""Distances, times and overshoot of made-up runs, and what the report says of them."""

import math

import numpy as np
import pytest

NAME = "robustness"
TIME = 0.2 * np.arange(301)


@pytest.fixture
def run(make_result):
    """Return a function that makes a run from the signed distances of both bodies, m."""

    def make(tractor, trailer=None, **metrics):
        errors = [np.broadcast_to(error, TIME.shape) for error in (tractor, tractor if trailer is None else trailer)]
        return make_result(
            {"measurement.time": TIME, "error.tractor": errors[0], "error.trailer": errors[1]}, **metrics
        )

    return make


def test_largest_distances_and_how_long_a_body_is_away(analysis, run) -> None:
    tractor = np.where((TIME > 25.1) & (TIME < 30.1), -0.3, 0.05)
    trailer = np.where((TIME > 28.1) & (TIME < 33.1), 0.2, 0.1)
    figures = analysis.figures(run(tractor, trailer))
    assert figures["tractor largest"] == pytest.approx(30.0)
    assert figures["trailer largest"] == pytest.approx(20.0)
    assert figures["tractor after 10 s"] == pytest.approx(5.0)
    assert figures["trailer after 10 s"] == pytest.approx(10.0)
    assert figures["settled"] == pytest.approx(33.2 - 25.2)
    assert math.isnan(figures["overshoot"])


def test_a_body_that_never_leaves_is_away_for_no_time(analysis, run) -> None:
    assert analysis.figures(run(0.14))["settled"] == 0.0


@pytest.mark.parametrize(("distance", "finished"), [(0.2, True), (0.1, False), (math.nan, True)])
def test_who_does_not_come_back_has_no_time(analysis, run, distance: float, finished: bool) -> None:
    tractor = np.where(TIME > 50.0, distance, 0.0)
    assert math.isnan(analysis.figures(run(tractor, finished=finished))["settled"])


def test_a_run_given_up_early_has_no_late_distance(analysis, make_result) -> None:
    columns = {"measurement.time": TIME[:50], "error.tractor": np.ones(50), "error.trailer": np.ones(50)}
    figures = analysis.figures(make_result(columns, finished=False))
    assert figures["tractor largest"] == 100.0
    assert math.isnan(figures["tractor after 10 s"])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_overshoot_is_beyond_the_path_from_where_the_tractor_starts(analysis, run, side: float) -> None:
    decay = 2.0 * np.exp(-TIME)
    late = np.where(TIME > 25.0, -0.5, 0.0)
    figures = analysis.figures(run(side * (decay + late), side * (decay - 0.08)))
    assert figures["overshoot"] == pytest.approx(8.0, abs=0.01)


def test_the_report_marks_misses_and_names_who_is_nearer(experiment, run, assemble, write_parts) -> None:
    sizes = {"articulated": 0.05, "articulated-centralised": 0.04, "paper": 0.8}
    results = {
        name: [run(sizes.get(name.partition(":")[0], 0.06) + 0.001 * seed) for seed in range(3)]
        for name in experiment.configurations
    }
    results["articulated: κ to 0.7"] = [run(0.2)] * 3
    results["paper: no event"] = [run(0.8), run(0.8), run(4.0, finished=False)]
    text, tables = write_parts(assemble(results))
    product = {row[0]: row for row in tables["product"].rows}
    assert product["no event"] == ["no event", "3/3", "5.1 ± 0.2 (5.2) ≤ 6", "5.1 ± 0.2 (5.2) ≤ 6", "0.0 ± 0.0 (0.0)"]
    assert product["κ to 0.7"][2:] == ["**20.0 ± 0.0 (20.0)** ≤ 14", "**20.0 ± 0.0 (20.0)** ≤ 8", "–"]
    assert not any(name.startswith("starts") for name in product)
    comparators = {row[0]: row[1:] for row in tables["comparators"].rows}
    assert comparators["no event"] == ["5.1 / 5.1", "4.1 / 4.1", *["6.1 / 6.1"] * 3, "186.7 / 186.7 (2/3)"]
    assert comparators["GPS lost 1 s"][1:] == [""] * 5
    events = {row[0]: row[1:] for row in tables["events"].rows}
    assert events["no event"] == ["400 / 400 (2/3)", "5 / 5"]
    assert events["κ to 0.7"] == ["80 / 80", "20 / 20"]
    assert "`articulated-centralised`: **no event (1.0 ± 0.0 / 1.0 ± 0.0)**" in text
    assert "`lqr-pi`: **κ to 0.7" in text
    assert "- `paper`: never" in text
    assert {row[0] for row in tables["starts"].rows} >= {"starts 2 m left", "starts turned by 180°"}
    slopes = {tuple(row[:2]): row[2:] for row in tables["slopes"].rows}
    left = "side slope 3° to the left"
    assert slopes[left, "limit of `articulated`"] == ["≤ 15", "≤ 15", "≤ 6", "≤ 8"]
    assert slopes[left, "articulated"][:2] == ["5.1 ± 0.2"] * 2
    assert {variant for variant, _ in slopes} == {left, "side slope 3° to the right"}
