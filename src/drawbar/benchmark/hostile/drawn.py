"""Drawn recipes: problems with many properties at once, each within its own range, whether or not a class has them."""

from typing import Any

import numpy as np

from drawbar.benchmark.hostile.construct import HostileProblem, optimal_problem
from drawbar.benchmark.hostile.recipe import FREE, GIVEN, Recipe, sizes

_SIZES = tuple(
    sizes(*shape, free_initial=free)
    for shape in ((1, 8, 4), (20, 6, 3), (40, 2, 1), (12, 10, 2), (60, 5, 1))
    for free in (False, True)
)
_SHARES = {
    "condition_decades": (0.4, 1.0, 10.0),
    "rank": (0.3, 0.2, 1.0),
    "degenerate": (0.4, 0.0, 0.8),
    "equal": (0.25, 0.0, 0.5),
    "soft": (0.5, 0.0, 1.0),
    "unit_decades": (0.3, 0.0, 4.0),
}
"""how often a field is drawn instead of left alone, and between what"""
_RANGES = {
    "input_weight_decades": (0.2, -10.0, 1.0),
    "growth": (0.7, 0.3, 1.6),
    "steering_decades": (0.3, -4.0, 1.0),
    "states_bounded": (1.0, 0.0, 1.0),
    "active": (1.0, 0.0, 1.0),
    "width_decades": (0.5, -6.0, 4.0),
    "reach_decades": (0.2, -3.0, 3.0),
    "multiplier_decades": (0.4, -6.0, 5.0),
    "cost_decades": (0.2, -8.0, 8.0),
}
"""likewise for pairs"""
_FLAGS = ("flat", "duplicates", "outputs")
_FLAGGED = 0.2


def drawn_recipe(rng: np.random.Generator) -> Recipe:
    """Return a recipe with every property drawn."""
    choice = GIVEN + FREE + _SIZES
    fields: dict[str, Any] = {name: bool(rng.random() < _FLAGGED) for name in _FLAGS}
    for name, (often, *ends) in _SHARES.items():
        if rng.random() < often:
            fields[name] = float(rng.uniform(ends[0], ends[1]))
    for name, (often, *ends) in _RANGES.items():
        if rng.random() < often:
            least, most = sorted(rng.uniform(ends[0], ends[1], 2))
            fields[name] = (float(least), float(most))
    bounded = float(rng.choice([0.0, 0.5, 1.0]))
    return Recipe(sizes=(choice[rng.integers(len(choice))],), inputs_bounded=bounded, **fields)


def drawn(rng: np.random.Generator) -> HostileProblem:
    """Return a problem of a drawn recipe."""
    return optimal_problem(rng, "drawn", drawn_recipe(rng))
