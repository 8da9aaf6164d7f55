"""Bounds of a body, less what an invariant set takes off them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from drawbar.control.tube.error_model import Limit
from drawbar.control.tube.invariant_set import InvariantSet
from drawbar.geometry import Floats

OF_ESTIMATE = "estimate now"
"""What the present error of the estimate takes off a bound, besides what it does to the set."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TightenedBound:
    """|nominal quantity| <= original without a tube, <= tightened with one, so that the vehicle's is <= reach."""

    name: str
    unit: str
    original: float
    reach: float
    contributions: Mapping[str, float]
    """what each source takes off, in the unit"""

    @property
    def tightening(self) -> float:
        """All that is taken off the reach."""
        return sum(self.contributions.values())

    @property
    def tightened(self) -> float:
        """What is left."""
        return min(self.original, self.reach - self.tightening)


def tightened_bounds(
    limits: tuple[Limit, ...], quantities: Floats, around: InvariantSet | None, beside: Floats
) -> dict[str, TightenedBound]:
    """Return the bounds of a body by name; nothing may be left of one.

    Args:
        limits: l of them.
        quantities: (l, n), how each depends on the invariant error.
        around: the invariant set, None without declared bounds.
        beside: (l,) what the present error of the estimate takes off each besides.
    """
    if around is None:
        return {
            limit.name: TightenedBound(
                name=limit.name, unit=limit.unit, original=limit.value, reach=limit.value, contributions={}
            )
            for limit in limits
        }
    names = [source.name for source in around.sources]
    taken = np.column_stack([around.contributions(quantities), beside]).tolist()
    return {
        limit.name: TightenedBound(
            name=limit.name,
            unit=limit.unit,
            original=limit.value,
            reach=limit.reach,
            contributions=dict(zip((*names, OF_ESTIMATE), parts, strict=True)),
        )
        for limit, parts in zip(limits, taken, strict=True)
    }
