"""Hostile problems whose truth is known: a claim is never wrong, and what a peer can solve is solved."""

import numpy as np
import pytest

from drawbar.benchmark.hostile.collection import CLASSES, hostile_problem
from drawbar.benchmark.hostile.solvers import SOLVERS
from drawbar.benchmark.hostile.table import share_of_peers, verdicts
from drawbar.benchmark.hostile.verdict import Answer, Verdict, gap, judge, sizes_by_kind, violation

PROBLEMS = 60
"""per class, tried by the peers too"""
MORE = 150
"""per class, tried by drawbar alone"""


@pytest.mark.parametrize("name", CLASSES)
def test_claims_are_right(name: str) -> None:
    found = [one["drawbar"] for one in verdicts(name, MORE, ["drawbar"])]
    assert Verdict.WRONG_SOLVED not in found
    assert Verdict.WRONG_INFEASIBLE not in found


def test_solves_what_a_peer_solves() -> None:
    found = [one for name in CLASSES for one in verdicts(name, PROBLEMS, list(SOLVERS), first=MORE)]
    known, shared = share_of_peers(found, "drawbar")
    assert known > 0.9 * len(found)
    assert shared >= 0.99 * known


@pytest.mark.parametrize("name", CLASSES)
def test_a_known_optimum_is_feasible_and_costs_nothing_more(name: str) -> None:
    for number in range(20):
        truth = hostile_problem(name, number)
        if truth.optimum is not None:
            assert violation(truth.problem, truth.optimum, sizes_by_kind(truth.problem, truth.optimum)) < 1e-9
            assert gap(truth, truth.optimum) == 0.0


def test_the_truth_is_the_same_whenever_it_is_drawn() -> None:
    one, again = (hostile_problem("soft", 7).problem.g for _ in range(2))
    np.testing.assert_array_equal(one, again)


def test_a_point_beside_the_optimum_is_no_solution() -> None:
    truth = hostile_problem("boxed", 3)
    assert truth.optimum is not None
    assert judge(truth, Answer(claim=Verdict.SOLVED, z=truth.optimum)) == Verdict.SOLVED
    assert judge(truth, Answer(claim=Verdict.SOLVED, z=truth.optimum + 1e-4)) == Verdict.WRONG_SOLVED
    assert judge(truth, Answer(claim=Verdict.INFEASIBLE)) == Verdict.WRONG_INFEASIBLE
    assert judge(truth, Answer(claim=Verdict.GIVEN_UP)) == Verdict.GIVEN_UP
