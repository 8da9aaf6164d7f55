"""The tables of the benchmarks and of a search in a narrow window: no figure is left out or cut."""

import io
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rich.console import Console, RenderableType

from drawbar.benchmark import bench
from drawbar.benchmark.hostile.table import hostile_table
from drawbar.benchmark.hostile.verdict import Verdict
from drawbar.experiment.tuning.comparison import Candidate, Comparison
from drawbar.experiment.tuning.report import terminal_table
from drawbar.experiment.tuning.study import Score, Trial
from drawbar.experiment.tuning.trials import Objectives

PROBLEMS = [f"{vehicle}, {which}" for vehicle in ("paper", "articulated") for which in ("tractor", "estimator")]


class Numbers:
    """Gives a number at a time, each of another text, and remembers the texts."""

    def __init__(self) -> None:
        self.value, self.given = 100.0, list[str]()

    def next(self) -> float:
        self.value += 7.0
        self.given.append(f"{self.value:.0f}")
        return self.value

    def four(self) -> dict[str, float]:
        return {name: self.next() for name in ("median", "mean", "p99", "max")}

    def three(self) -> dict[str, float]:
        return {name: self.next() for name in ("median", "mean", "p99")}


def row(numbers: Numbers, problem: str, stages: int) -> dict[str, Any]:
    base = {"problem": problem, "stages": stages, "total_us": {"median": 4.0, "mean": 4.0, "p99": 4.0, "max": 4.0}}
    once = {"prepare_us": 4.0, "feedback_us": 4.0, "floor_us": 4.0, "ratio_to_floor": 1.25, "bounded_share": 0.5}
    if stages == bench.STAGES:
        base["total_us"] = numbers.four()
        once |= {"feedback_free_us": numbers.three(), "feedback_active_us": numbers.three()}
    return base | once


def race(numbers: Numbers, problem: str, stages: int, solver: str) -> dict[str, Any]:
    times = {"free_us": numbers.three(), "active_us": numbers.three()} if stages == bench.STAGES else {}
    alike = {"free_us": {"median": 4.0}, "problems": 12, "other_answers": 3}
    return {"problem": problem, "stages": stages, "solver": solver} | alike | times


def printed(shown: Any, width: int) -> str:
    console = Console(file=io.StringIO(), width=width)
    shown(console)
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def lost(text: str, width: int, figures: list[str]) -> set[str]:
    """Return the figures that a table does not show, and its lines that are cut or wider than the window."""
    cut = {line for line in text.splitlines() if len(line) > width or "…" in line}
    return cut | (set(figures) - set(text.split()))


STARTS = ("import", "first_step", "cold_first_step")


@pytest.mark.parametrize("width", [24, 40, 60, 80])
def test_bench_shows_every_figure(width: int) -> None:
    numbers, solvers = Numbers(), ("drawbar", "HPIPM", "DAQP", "PIQP")
    stages = (bench.STAGES, *bench.GROWTH)
    one = {"wall": 1.0}
    figures = {
        "rows": [row(numbers, problem, n) for problem in PROBLEMS for n in stages],
        "peers": [race(numbers, problem, n, name) for problem in PROBLEMS for n in stages for name in solvers],
        "peers_missing": {"PIQP": "it is not installed"},
        "start_up": {f"{key}{unit}": 0.25 for key in STARTS for unit in ("_s", "_cpu_s")},
        **{f"{key}_us": one for key in ("c_step", "c_step_free", "c_step_active", "c_step_preparation")},
        **{f"{key}_us": one for key in ("control_step", "python")},
        **dict.fromkeys(("real_time_factor", "real_time_factor_logged"), 1650.0),
    }
    assert not lost(printed(lambda console: bench.show(console, figures), width), width, numbers.given)


@pytest.mark.parametrize("width", [24, 40, 60, 80])
def test_the_hostile_problems_show_every_figure(width: int) -> None:
    solvers = ("drawbar", "HPIPM", "DAQP", "PIQP", "Clarabel")
    found = {
        name: [dict.fromkeys(solvers, Verdict.SOLVED if good else Verdict.GIVEN_UP) for good in range(2)] * count
        for count, name in enumerate(("ill conditioned", "no interior", "long horizon"), 101)
    }
    text = printed(lambda console: console.print(hostile_table(found)), width)
    assert not lost(text, width, ["202", "204", "206", "612"])


@pytest.mark.parametrize("width", [24, 40, 60, 80])
def test_a_search_shows_every_value(width: int) -> None:
    keys = ["controller.tractor.lateral", "estimator.screening.settling", "guidance.look_ahead"]
    values = {key: 1234.0 + 111.0 * place for place, key in enumerate(keys)}
    fresh = Objectives(error=np.full(4, 0.0125), effort=np.full(4, 0.25), given_up=1)
    trial = Trial(number=0, values=values, outcome=Score(error=0.0, effort=0.0))
    findings: Any = SimpleNamespace(
        comparison=Comparison(own=Candidate(trial=trial, fresh=fresh), front=[]),
        space=SimpleNamespace(parameters=[SimpleNamespace(key=key) for key in keys]),
    )
    shown: RenderableType = terminal_table(findings)
    text = printed(lambda console: console.print(shown), width)
    assert not lost(text, width, ["1.25", "14.32", "1234", "1345", "1456"])
    assert {part for key in keys for part in key.split(".")} <= {word.lstrip(".") for word in text.split()}
