"""Errors, deviations and consistency of made-up estimates."""

import numpy as np
import pytest

NAME = "slip-estimates"
COUNT = 20000
TIME = np.linspace(0.0, 100.0, COUNT)
TRUTH, SIGMA = 0.8, 0.02


@pytest.fixture
def run(make_result):
    """Return a function that makes a run whose estimates err by SIGMA, and claim a multiple of it."""

    def make(seed: int = 0, claim: float = 1.0, *, with_eta: bool = True):
        noise = np.random.default_rng(seed)
        columns = {"measurement.time": TIME}
        for slip, truth in (("longitudinal_slip", TRUTH), ("tractor_slip", TRUTH), ("trailer_slip", 1.0)):
            columns[f"truth.{slip}"] = np.full(COUNT, truth)
            columns[f"estimate.{slip}"] = truth + SIGMA * noise.standard_normal(COUNT)
            columns[f"deviation.{slip}"] = np.full(COUNT, claim * SIGMA)
        if not with_eta:
            columns["estimate.trailer_slip"], columns["deviation.trailer_slip"] = np.ones(COUNT), np.full(COUNT, np.nan)
        for body in ("tractor", "trailer"):
            columns[f"truth.{body}.yaw"] = 0.1 * TIME
            columns[f"estimate.{body}.yaw"] = 0.1 * TIME + SIGMA * noise.standard_normal(COUNT) + 2.0 * np.pi
            columns[f"deviation.{body}_yaw"] = np.full(COUNT, claim * SIGMA)
        columns["estimate.longitudinal_slip"][TIME < 9.0] = 0.0  # the start does not count
        return make_result(columns)

    return make


def test_errors_as_large_as_claimed_are_consistent(analysis, run) -> None:
    figures = analysis.figures(run())
    for symbol in ("μ", "κ", "η"):
        assert figures[f"{symbol} error"] == pytest.approx(SIGMA, rel=0.03)
        assert figures[f"{symbol} deviation"] == pytest.approx(SIGMA)
        assert figures[f"{symbol} inside"] == pytest.approx(99.73, abs=0.15)
    assert figures["trailer yaw error"] == pytest.approx(np.degrees(SIGMA), rel=0.03)
    assert figures["trailer yaw inside"] == pytest.approx(99.73, abs=0.15)


def test_too_bold_a_claim_is_seen(analysis, run) -> None:
    figures = analysis.figures(run(claim=1.0 / 3.0))
    assert figures["κ inside"] == pytest.approx(68.3, abs=1.0)
    assert figures["tractor yaw inside"] == pytest.approx(68.3, abs=1.0)


def test_a_slip_that_the_model_does_not_have_has_no_figures(analysis, run) -> None:
    figures = analysis.figures(run(with_eta=False))
    assert all(np.isnan(figures[f"η {what}"]) for what in ("error", "deviation", "inside"))


def test_the_report_counts_samples_on_each_cases_own_bounds(experiment, run, assemble, write_parts) -> None:
    results = {case: [run(with_eta=case.startswith("paper"))] for case in experiment.configurations}
    held = results["paper"][0].columns["estimate.tractor_slip"]
    held[: COUNT // 4], held[COUNT // 4 : COUNT // 2] = 0.25, 1.0
    held[COUNT // 2 :] = 0.999  # near a bound is not on it
    results["articulated"][0].columns["estimate.tractor_slip"][: COUNT // 2] = 0.5
    text, tables = write_parts(assemble(results))
    slips = {row[0]: dict(zip(tables["slips"].header, row, strict=True)) for row in tables["slips"].rows}
    assert slips["paper"]["κ on bound"] == "50.0 %"
    assert slips["articulated"]["κ on bound"] == "50.0 %"
    assert slips["paper, no bounds"]["κ on bound"] == "0.0 %"
    assert slips["articulated"]["η error"] == ""
    assert slips["paper-ekf"]["η error"] == "0.020 (0.020)"
    assert tables["yaws"].rows[0][:2] == ["paper", "1.15 (1.15)"]
    assert "(slips-paper.svg)" in text
    assert "(slips-articulated.svg)" in text
