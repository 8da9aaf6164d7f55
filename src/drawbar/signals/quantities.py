"""Quantities: what a number of a signal measures, in which unit, and the shape of an array in C."""

import math
from dataclasses import dataclass
from typing import Annotated


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """What a number measures."""

    unit: str
    limit: float = math.inf
    """largest magnitude that a sensor can have meant; a measured value beyond it is taken for missing"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Array:
    """The shape of an array in C: of fixed size, or rows behind a pointer."""

    columns: int
    """numbers in a row; 0: the rows are single numbers"""
    rows: str = ""
    """how many rows the pointer leads to; empty: the array is one row within the structure"""
    counted: bool = False
    """the number of rows is a member of the structure, of that name"""


Seconds = Annotated[float, Quantity(unit="s")]
Metres = Annotated[float, Quantity(unit="m", limit=1e7)]  # beyond 1e7 m a double holds too few digits
Radians = Annotated[float, Quantity(unit="rad", limit=2.0 * math.pi)]
MetresPerSecond = Annotated[float, Quantity(unit="m/s", limit=50.0)]
RadiansPerSecond = Annotated[float, Quantity(unit="rad/s", limit=50.0)]
Ratio = Annotated[float, Quantity(unit="1")]
