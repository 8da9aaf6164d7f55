"""Verdict on an answer, by the truth alone."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from drawbar.benchmark.hostile.construct import HostileProblem
from drawbar.geometry import Floats
from drawbar.optimal.stage_problem import StageProblem

TOLERANCE = 1e-6
"""relative: an answer called a solution may violate nothing by more, and cost no more than the optimum"""


class Verdict(StrEnum):
    """What came of one problem."""

    SOLVED = "solved"
    """rightly"""
    INFEASIBLE = "infeasible"
    """rightly"""
    WRONG_SOLVED = "wrong solved"
    WRONG_INFEASIBLE = "wrong infeasible"
    GIVEN_UP = "given up"
    """nothing was claimed"""

    @property
    def right(self) -> bool:
        """The truth was found."""
        return self in (Verdict.SOLVED, Verdict.INFEASIBLE)


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What a solver reports."""

    claim: Verdict
    """SOLVED, INFEASIBLE or GIVEN_UP"""
    z: Floats | None = None
    """(NZ,) the point that it calls optimal"""


def sizes_by_kind(problem: StageProblem, z: Floats) -> Floats:
    """Return the largest of each state's and each input's values over the stages, at each variable's place (NZ,)."""
    x, u = problem.split(np.abs(z))
    N = problem.sizes.stages
    return np.concatenate([np.tile(x.max(axis=0), N + 1), np.tile(u.max(axis=0), N)])


def violation(problem: StageProblem, z: Floats, size: Floats) -> float:
    """Return by how much z violates dynamics, first state or a hard bound, relative to the sizes (NZ,)."""
    nx = problem.sizes.states
    size = np.maximum(size, 1e-6 * size.max())
    hard = ~np.isfinite(problem.soft_linear)
    outside = (problem.violations(z) / size[problem.bound])[:, hard]
    worst = [outside.max(initial=0.0), (np.abs(problem.defects(z)) / size[:nx]).max()]
    if not problem.sizes.free_initial:
        worst.append((np.abs(z[:nx] - problem.initial) / size[:nx]).max())
    return float(max(worst))


def gap(truth: HostileProblem, z: Floats) -> float:
    """Return by how much z (NZ,) costs more or less than the optimum, relative to the parts of the optimal cost."""
    assert truth.optimum is not None
    problem, best = truth.problem, truth.optimum
    penalty = problem.penalty(best)
    size = abs(0.5 * best @ problem.weighed(best)) + abs(problem.g @ best) + penalty
    step = z - best
    change = step @ (0.5 * problem.weighed(z + best) + problem.g) + problem.penalty(z) - penalty
    return float(abs(change) / size)


def judge(truth: HostileProblem, answer: Answer) -> Verdict:
    """Return what the answer is worth."""
    if answer.claim == Verdict.INFEASIBLE:
        return Verdict.INFEASIBLE if truth.optimum is None else Verdict.WRONG_INFEASIBLE
    if answer.claim != Verdict.SOLVED or answer.z is None:
        return Verdict.GIVEN_UP
    size = sizes_by_kind(truth.problem, answer.z)
    if truth.optimum is not None:
        size = np.maximum(size, sizes_by_kind(truth.problem, truth.optimum))
    good = bool(np.isfinite(answer.z).all()) and violation(truth.problem, answer.z, size) <= TOLERANCE
    if truth.optimum is not None:
        good = good and gap(truth, answer.z) <= TOLERANCE
    return Verdict.SOLVED if good else Verdict.WRONG_SOLVED
