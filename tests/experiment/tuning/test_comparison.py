"""Who is better than the configuration's own values on fresh seeds, and whom one would choose."""

import dataclasses

import numpy as np
import pytest

from drawbar.experiment.tuning.comparison import Candidate, Comparison
from drawbar.experiment.tuning.study import Score, Trial
from drawbar.experiment.tuning.trials import Objectives

SEEDS = np.random.default_rng(0).normal(0.0, 0.3, 10)
"""what every configuration meets alike with a seed"""


def candidate(number: int, error: float, effort: float, *, luck: float = 0.0, given_up: int = 0) -> Candidate:
    """Return a candidate whose error is that of its seeds, with or without some luck in each."""
    own_luck = luck * np.random.default_rng(number).normal(0.0, 1.0, 10)
    fresh = Objectives(error=error + SEEDS + own_luck, effort=np.full(10, effort), given_up=given_up)
    return Candidate(trial=Trial(number=number, values={}, outcome=Score(error=0.0, effort=0.0)), fresh=fresh)


OWN = candidate(0, 1.0, 2.0)


def test_a_small_gain_shows_seed_by_seed_though_the_seeds_scatter_more() -> None:
    small, lucky = candidate(1, 0.99, 2.0), candidate(2, 0.99, 2.0, luck=0.5)
    comparison = Comparison(own=OWN, front=[small, lucky])
    assert small.error.half_width > 0.1
    error, effort = comparison.gain(small)
    assert (error.mean, error.half_width) == pytest.approx((-0.01, 0.0), abs=1e-12)
    assert effort.mean == 0.0
    assert comparison.better() == [small]


@pytest.mark.parametrize(
    ("error", "effort", "better"),
    [(0.9, 1.9, True), (1.0, 1.9, True), (0.9, 2.1, False), (1.1, 1.9, False), (1.0, 2.0, False)],
)
def test_better_is_no_worse_in_either(error: float, effort: float, better: bool) -> None:
    assert bool(Comparison(own=OWN, front=[candidate(1, error, effort)]).better()) == better


def test_what_was_given_up_is_neither_better_nor_chosen() -> None:
    lost = candidate(1, 0.1, 0.1, given_up=1)
    comparison = Comparison(own=OWN, front=[lost])
    assert comparison.better() == []
    assert set(map(id, comparison.picks().values())) == {id(OWN)}


def test_each_is_chosen_for_what_it_is_the_best_in() -> None:
    precise, both, calm, idle = (
        candidate(number, error, effort)
        for number, (error, effort) in enumerate([(0.5, 3.0), (0.9, 1.95), (0.95, 1.5), (1.5, 1.0)], 1)
    )
    comparison = Comparison(own=OWN, front=[precise, both, calm, idle])
    assert {title: one.trial.number for title, one in comparison.picks().items()} == {
        "least error": 1,
        "least error with no more steering": 2,
        "least steering with no more error": 3,
    }


def test_scores_are_means_over_the_runs() -> None:
    score = dataclasses.replace(OWN.fresh, given_up=2).score()
    assert score.error == pytest.approx(1.0 + SEEDS.mean())
    assert (score.effort, score.unfinished) == (pytest.approx(2.0), 0.2)
