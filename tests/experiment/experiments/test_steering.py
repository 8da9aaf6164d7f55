"""Shares and lags of made-up steering."""

import numpy as np
import pytest

from drawbar.report.path_errors import Bodies

NAME = "steering"
PROGRESS = np.linspace(0.0, 60.0, 301)
COMMAND = np.radians(10.0) * np.sin(0.3 * PROGRESS)


@pytest.fixture
def run(make_result):
    """Return a function that makes a run whose joints follow the commands after one sample, times a sense."""

    def make(config: str, sense: float = 1.0):
        follow = np.concatenate([[0.0], COMMAND[:-1]])
        columns = {
            "measurement.time": PROGRESS,
            "tractor_steering.command": COMMAND,
            "trailer_steering.command": 2.0 * COMMAND,
            "tractor_steering.ancillary": 0.01 * np.abs(COMMAND),
            "trailer_steering.ancillary": -0.1 * COMMAND,
            "truth.tractor_steering": follow + np.radians(0.5),
            "truth.trailer_steering": sense * 2.0 * follow,
        }
        columns |= {f"progress.{body}": PROGRESS for body in ("tractor", "trailer")}
        shares = {
            "ancillary_share": Bodies(tractor=0.0, trailer=-0.05),
            "saturated_share": Bodies(tractor=0.0, trailer=0.25),
        }
        return make_result(columns, config=config, **shares)

    return make


def test_shares_are_per_cent_and_the_lag_is_behind_the_last_command(analysis, run) -> None:
    figures = analysis.figures(run("articulated"))
    assert figures["tractor ancillary size"] == pytest.approx(1.0)
    assert figures["trailer ancillary size"] == pytest.approx(5.0)
    assert figures["trailer ancillary share"] == pytest.approx(-5.0)
    assert figures["trailer clipped"] == 25.0
    assert figures["tractor lag"] == pytest.approx(0.5)
    assert figures["trailer lag"] == pytest.approx(0.0, abs=1e-12)


def test_the_papers_reversed_joint_is_seen_in_the_sense_of_its_command(analysis, run) -> None:
    assert analysis.figures(run("paper", sense=-1.0))["trailer lag"] == pytest.approx(0.0, abs=1e-12)
    assert analysis.figures(run("articulated", sense=-1.0))["trailer lag"] > 10.0


def test_the_report_sets_the_papers_shares_beside_ours(analysis, run, assemble, write_parts) -> None:
    results = {"paper": [run("paper", -1.0)] * 2, "articulated": [run("articulated")] * 2}
    text, tables = write_parts(assemble(results))
    rows = {(row[0], row[1]): row for row in tables["shares"].rows}
    assert rows["the paper", "trailer"][2] == "≈ 5"
    assert rows["paper", "tractor"][-1] == "0.0"
    near = np.abs(2.0 * np.degrees(COMMAND)) >= 19.0
    assert rows["articulated", "trailer"][-1] == f"{100.0 * near.mean():.1f}"
    assert "(steering-paper.svg)" in text
    assert "(close-up.svg)" in text
