"""Collection of all classes of hostile problems, each problem known by its class and number."""

from collections.abc import Callable, Iterator
from dataclasses import fields

import numpy as np

from drawbar.benchmark.hostile.construct import HostileProblem, optimal_problem
from drawbar.benchmark.hostile.drawn import drawn
from drawbar.benchmark.hostile.edge import first_state, hidden_conflict, just_feasible, just_infeasible
from drawbar.benchmark.hostile.recipe import LATER, QUADRATIC_PRICES, RECIPES, Recipe
from drawbar.benchmark.hostile.rounding import moved_by_rounding


def _maker(name: str, recipe: Recipe) -> Callable[[np.random.Generator], HostileProblem]:
    return lambda rng: optimal_problem(rng, name, recipe)


def mixed(rng: np.random.Generator) -> HostileProblem:
    """Return a problem that takes each of its properties from another class."""
    recipes = list(RECIPES.values())
    names = [field.name for field in fields(Recipe)]
    drawn = {name: getattr(recipes[rng.integers(len(recipes))], name) for name in names}
    return optimal_problem(rng, "mixed", Recipe(**drawn))


CLASSES: dict[str, Callable[[np.random.Generator], HostileProblem]] = {
    **{name: _maker(name, recipe) for name, recipe in RECIPES.items()},
    "mixed": mixed,
    "just feasible": just_feasible,
    "just infeasible": just_infeasible,
    "hidden conflict": hidden_conflict,
    **{name: _maker(name, recipe) for name, recipe in LATER.items()},
    "first state": first_state,
    "moved by rounding": moved_by_rounding,
    "quadratic prices": _maker("quadratic prices", QUADRATIC_PRICES),
    "drawn": drawn,
}


def hostile_problem(name: str, number: int) -> HostileProblem:
    """Return one problem; the same for the same class and number, whatever else was drawn."""
    return CLASSES[name](np.random.default_rng([list(CLASSES).index(name), number]))


def hostile_problems(name: str, count: int, first: int = 0) -> Iterator[HostileProblem]:
    """Return problems `first` to `first + count` of a class."""
    return (hostile_problem(name, number) for number in range(first, first + count))
