"""Recipes, as data: the classes of hostile problems with a known optimum."""

from dataclasses import dataclass, replace

from drawbar.optimal.quadratic_program import Sizes

SMALL = ((2, 1, 1), (5, 2, 1), (10, 3, 1), (8, 2, 2), (6, 5, 2), (15, 4, 2), (30, 3, 1))
LONG = ((100, 4, 2), (200, 3, 1))
SPARE = 4
"""bounds beyond one for each variable: a variable may be bounded twice"""


def sizes(stages: int, states: int, inputs: int, *, free_initial: bool) -> Sizes:
    """Return sizes with room for a bound on every variable, and SPARE more."""
    first = states if free_initial else 0
    bounds = stages * (states + inputs) + first + SPARE
    return Sizes(stages=stages, states=states, inputs=inputs, bounds=bounds, free_initial=free_initial)


GIVEN = tuple(sizes(*shape, free_initial=False) for shape in SMALL)
FREE = tuple(sizes(*shape, free_initial=True) for shape in SMALL)
LONGEST = tuple(sizes(*shape, free_initial=free) for shape in LONG for free in (False, True))


@dataclass(frozen=True, slots=True, kw_only=True)
class Recipe:
    """How a problem is drawn; pairs are least and largest, `..._decades` of powers of ten."""

    sizes: tuple[Sizes, ...] = GIVEN + FREE[:3]
    """one of them is drawn"""
    condition_decades: float = 1.0
    """of each stage's cost: eigenvalues from 10^-condition to 1"""
    rank: float = 1.0
    """share of the cost's eigenvalues that are not exactly zero"""
    input_weight_decades: tuple[float, float] | None = None
    """R is a multiple of the identity instead, and inputs and states have no common cost"""
    redundant: bool = False
    """all inputs do and cost the same, so that only their sum is determined"""
    growth: tuple[float, float] = (0.7, 1.1)
    """largest modulus among the eigenvalues of A"""
    steering_decades: tuple[float, float] = (0.0, 0.0)
    """size of B, drawn for each stage"""
    inputs_bounded: float = 1.0
    """share of inputs that have bounds"""
    states_bounded: tuple[float, float] = (0.0, 0.5)
    """share of states"""
    active: tuple[float, float] = (0.0, 0.8)
    """share of bounds that the optimum sits on"""
    degenerate: float = 0.0
    """share of those whose multiplier is zero"""
    width_decades: tuple[float, float] = (-0.5, 0.7)
    """of the boxes"""
    equal: float = 0.0
    """share of bounds whose lower and upper side are equal"""
    soft: float = 0.0
    """share of state bounds that are soft"""
    flat: bool = False
    """the first unit of a violation costs nothing: all prices are quadratic"""
    duplicates: bool = False
    """SPARE variables are bounded twice, the same or looser"""
    outputs: bool = False
    """the last half of the states are bounded outputs: they cost nothing, and nothing follows from them"""
    reach_decades: tuple[float, float] = (0.0, 0.0)
    """size of the optimum's inputs"""
    multiplier_decades: tuple[float, float] = (-3.0, 2.0)
    """of active bounds"""
    cost_decades: tuple[float, float] = (0.0, 0.0)
    """the whole cost is multiplied by one such number"""
    unit_decades: float = 0.0
    """each state and input is given in a unit within so many decades of its own, either way"""


_PLAIN = Recipe()
RECIPES = {
    "boxed": _PLAIN,
    "ill conditioned": replace(_PLAIN, condition_decades=12.0),
    "near singular": replace(_PLAIN, input_weight_decades=(-12.0, -4.0)),
    "semidefinite": replace(_PLAIN, rank=0.4),
    "redundant inputs": replace(_PLAIN, sizes=(GIVEN[3], GIVEN[4], GIVEN[5], FREE[4]), redundant=True),
    "linear": replace(_PLAIN, cost_decades=(-9.0, -5.0), multiplier_decades=(5.0, 9.0)),
    "scaled": replace(_PLAIN, cost_decades=(-8.0, 8.0), unit_decades=4.0, soft=0.3),
    "thin boxes": replace(_PLAIN, width_decades=(-9.0, -3.0)),
    "equal bounds": replace(_PLAIN, equal=0.4),
    "unstable": replace(_PLAIN, growth=(1.2, 3.0), inputs_bounded=0.5),
    "duplicates": replace(_PLAIN, duplicates=True),
    "degenerate": replace(_PLAIN, degenerate=0.6),
    "soft": replace(_PLAIN, soft=1.0, states_bounded=(0.3, 1.0)),
    "unbounded inputs": replace(
        _PLAIN,
        inputs_bounded=0.0,
        steering_decades=(-4.0, 0.0),
        reach_decades=(0.0, 4.0),
        width_decades=(-4.0, 1.0),
        multiplier_decades=(-4.0, 3.0),
    ),
    "uneven inputs": replace(
        _PLAIN,
        inputs_bounded=0.0,
        steering_decades=(-8.0, 0.0),
        reach_decades=(0.0, 6.0),
        width_decades=(-4.0, 1.0),
    ),
    "free first state": replace(_PLAIN, sizes=FREE, inputs_bounded=0.3),
    "long": replace(_PLAIN, sizes=LONGEST),
    "long, unstable, unbounded": replace(_PLAIN, sizes=LONGEST, growth=(0.9, 3.0), inputs_bounded=0.0),
}
LATER = {
    "bounded outputs": replace(_PLAIN, sizes=(GIVEN[3], GIVEN[4], GIVEN[5]), outputs=True, states_bounded=(0.5, 1.0)),
    "few bounds": replace(_PLAIN, rank=0.5, inputs_bounded=0.0, states_bounded=(0.0, 0.1)),
    "far bounds": replace(_PLAIN, rank=0.5, width_decades=(3.0, 9.0), multiplier_decades=(-12.0, -3.0)),
    "far soft bounds": replace(_PLAIN, rank=0.0, soft=1.0, width_decades=(3.0, 9.0), states_bounded=(0.3, 1.0)),
    "tiny cost": replace(_PLAIN, cost_decades=(-30.0, -8.0)),
    "crowded": replace(_PLAIN, sizes=LONGEST, states_bounded=(0.5, 1.0)),
}
"""found when the others were there; the mixed ones have nothing of them, and stay what they were"""
QUADRATIC_PRICES = replace(_PLAIN, soft=1.0, flat=True, states_bounded=(0.3, 1.0))
DENSE = (sizes(1, 12, 8, free_initial=False), sizes(1, 20, 10, free_initial=False))
"""one stage, as a dense program becomes"""
