"""Error model of one body, data only: how e = x - x̄ grows over a sample, what disturbs it, what it must not exceed."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats

OPERATING_POINT = "operating point"
"""Name of the source that is not declared but follows from the ranges of the operating points."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """One thing that disturbs the error over a sample: w with |w| <= bound, through a set that scales with it."""

    name: str
    unit: str
    bound: float
    """largest magnitude, in the unit"""
    generators: Floats
    """(v, g, n): per unit of the bound. The set is the convex hull, over the v operating points, of the zonotopes that
    g segments from -row to +row sum up to"""

    def support(self, directions: Floats) -> Floats:
        """Return max a·w over the set for directions a (..., n): (...,)."""
        segments = np.abs(np.einsum("...n,vgn->...vg", directions, self.generators))
        return self.bound * np.asarray(segments.sum(axis=-1).max(axis=-1))

    def within(self, coordinates: NDArray[np.intp]) -> Self:
        """Return the source projected onto the coordinates with these indices (m,)."""
        inner = self.generators[:, :, coordinates]
        return type(self)(name=self.name, unit=self.unit, bound=self.bound, generators=inner)


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorModel:
    """e+ = A e + B (u - ū) + G w at v operating points, the first of them the nominal one; u is the command, rad."""

    states: tuple[str, ...]
    """names of the n errors"""
    units: tuple[str, ...]
    """(n,): their units"""
    A: Floats
    """(v, n, n)"""
    B: Floats
    """(v, n)"""
    disturbances: tuple[str, ...]
    """names of the d things that may disturb the error"""
    disturbance_units: tuple[str, ...]
    """(d,): their units"""
    G: Floats
    """(v, n, d), w held over the sample"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """|state · x + command u| <= reach for the vehicle, and nominally <= value: a bound that the tube tightens."""

    name: str
    unit: str
    value: float
    reach: float
    """how far the vehicle itself may go: its bound, or what its error model is true for"""
    state: Floats
    """(n,)"""
    command: float
