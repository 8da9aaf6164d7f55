"""Results of drawbar and its peers on problems whose optimum is not known beforehand."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from rich.console import Group, RenderableType
from rich.text import Text
from scipy.optimize import nnls

from drawbar.benchmark.hostile.construct import HostileProblem
from drawbar.benchmark.hostile.solvers import SOLVERS
from drawbar.benchmark.hostile.verdict import TOLERANCE, Answer, Verdict, judge, sizes_by_kind, violation
from drawbar.benchmark.published.families import Published
from drawbar.geometry import Floats
from drawbar.optimal.stage_problem import StageProblem
from drawbar.terminal import FittedTable


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """One problem, and what each solver made of it."""

    published: Published
    answers: dict[str, Answer]
    """by solver"""
    verdicts: dict[str, Verdict]
    """by solver, judged by the cheapest admissible answer of all"""
    optimality: float | None
    """of drawbar's point, see `stationarity`; None without one"""


def cost(problem: StageProblem, z: Floats) -> float:
    """Return the cost of a point (NZ,)."""
    return float(0.5 * z @ problem.weighed(z) + problem.g @ z + problem.penalty(z))


def stationarity(problem: StageProblem, z: Floats) -> float:
    """Return the part of the gradient at a point (NZ,) that no active bound explains, relative to the gradient's terms.

    The inputs' gradient, with the states eliminated, is explained as well as possible by multipliers of the right
    signs; no solver's own multipliers are asked. Bounds are hard.
    """
    T, _ = problem.reach()
    size = sizes_by_kind(problem, z)
    near = TOLERANCE * np.maximum(size, 1e-3 * size.max())[problem.bound]
    value = z[problem.bound]
    sides = [(problem.bound[i], 1.0) for i in np.flatnonzero(value - problem.lower <= near)]
    sides += [(problem.bound[i], -1.0) for i in np.flatnonzero(problem.upper - value <= near)]
    gradient = T.T @ (problem.weighed(z) + problem.g)
    terms = np.abs(T).T @ (np.abs(problem.weighed(z)) + np.abs(problem.g))
    left = np.abs(gradient)
    if sides:
        pulls = np.column_stack([sign * T[at] for at, sign in sides])
        left = np.abs(pulls @ nnls(pulls, gradient, maxiter=100 * len(sides))[0] - gradient)
    return float(left.max() / terms.max())


def compare(published: Published, solvers: Sequence[str]) -> Compared:
    """Let all solvers solve one problem."""
    problem = published.problem
    answers = {solver: SOLVERS[solver](problem) for solver in solvers}
    points = [answer.z for answer in answers.values() if answer.claim == Verdict.SOLVED and answer.z is not None]
    admissible = [z for z in points if violation(problem, z, sizes_by_kind(problem, z)) <= 1e-7]
    best = min(admissible, key=lambda z: cost(problem, z), default=None)
    truth = HostileProblem(name=published.name, problem=problem, optimum=best)
    own = answers["drawbar"].z if answers["drawbar"].claim == Verdict.SOLVED else None
    return Compared(
        published=published,
        answers=answers,
        verdicts={solver: judge(truth, answer) for solver, answer in answers.items()},
        optimality=None if own is None else stationarity(problem, own),
    )


def published_table(found: Sequence[Compared]) -> RenderableType:
    """Return how many problems of each family each solver solved, and the worst of drawbar's points."""
    solvers = list(found[0].answers)
    title = f"{len(found)} published problems of model predictive control: solved"
    shown = list[tuple[str, list[str]]]()
    for family in dict.fromkeys(each.published.family for each in found):
        rows = [each for each in found if each.published.family == family]
        sizes = [each.published.problem.sizes for each in rows]
        spans = [_span([getattr(size, of) for size in sizes]) for of in ("stages", "states", "inputs")]
        solved = [str(sum(each.verdicts[solver].right for each in rows)) for solver in solvers]
        known = [each.optimality for each in rows if each.optimality is not None]
        shown.append((family, [str(len(rows)), *spans, *solved, f"{max(known):.1e}" if known else ""]))
    columns = [(name, "") for name in ("problems", "stages", "states", "inputs", *solvers, "gradient left\nby drawbar")]
    return Group(Text(title, "bold"), FittedTable("family", columns, shown, title_width=len("family"), column_width=4))


def _span(values: Sequence[int]) -> str:
    return str(min(values)) if min(values) == max(values) else f"{min(values)} to {max(values)}"
