"""A product beside others, over the same variants."""

from collections.abc import Callable

from drawbar.experiment.comparison import comparison
from drawbar.experiment.elements import Table, Text
from drawbar.experiment.experiment import Experiment
from drawbar.experiment.measure import Runs
from drawbar.experiment.measured import MeasuredExperiment

TOML = """
title = "Compared"
cases = [{ name = "a", configuration = "articulated" }, { name = "b", configuration = "paper", variants = ["x", "y"] }]
variants = [{ name = "x" }, { name = "y" }, { name = "z" }]
"""
FIGURES = [f"{body} {name}" for name in ("mean", "largest", "SD", "95 %") for body in ("tractor", "trailer")]


def test_means_stand_side_by_side_and_who_is_nearer_with_both_bodies_is_named(
    write_experiment: Callable[[str], Experiment], short_result
) -> None:
    driven = {"a: x": (2.0, 2.0), "a: y": (1.0, 1.0), "a: z": (1.0, 1.0), "b: x": (1.0, 1.5), "b: y": (0.5, 1.5)}
    runs = {name: Runs(results=[short_result], failures=[]) for name in driven}
    others = (9.0, 8.0, 1.5, 1.6, 4.0, 5.0)
    figures = {name: [dict(zip(FIGURES, (*each, *others), strict=True))] for name, each in driven.items()}
    measured = MeasuredExperiment(experiment=write_experiment(TOML), seeds=1, runs=runs, figures=figures)
    table, spreads, said = comparison(measured, "a")
    assert isinstance(table, Table)
    assert isinstance(spreads, Table)
    assert isinstance(said, Text)
    assert table.rows == [
        ["x", "2.0 / 2.0, 9 / 8", "1.0 / 1.5, 9 / 8"],
        ["y", "1.0 / 1.0, 9 / 8", "0.5 / 1.5, 9 / 8"],
    ]
    assert spreads.rows[0] == ["x", *2 * ["1.5 / 1.6, 4.0 / 5.0"]]
    assert "- `b`: x\n" in said.text
