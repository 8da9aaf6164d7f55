"""Bound of a variable of a problem."""

import math
from dataclasses import dataclass

from drawbar.errors import SolverError
from drawbar.optimal.given import check_numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound:
    """lower <= variable <= upper at every stage; hard unless a penalty is given."""

    lower: float
    upper: float
    linear_penalty: float = math.inf
    """cost of a violation, per unit, beside half the sum of squares; infinite: the bound is hard; zero: the bound gives
    way as far as the quadratic penalty lets it"""
    quadratic_penalty: float = 0.0
    """cost of a violation, per unit squared (half of it, as in 1/2 q v²)"""

    def __post_init__(self) -> None:
        check_numbers(
            "A bound",
            lower=self.lower,
            upper=self.upper,
            linear_penalty=self.linear_penalty,
            quadratic_penalty=self.quadratic_penalty,
        )
        if not self.lower <= self.upper:
            raise SolverError(
                f"A bound needs lower <= upper, got lower = {self.lower} and upper = {self.upper}; give two numbers "
                f"in this order, infinite where there is no bound."
            )
        if self.lower == math.inf or self.upper == -math.inf:
            raise SolverError(
                f"A bound needs lower < infinity and upper > -infinity, got lower = {self.lower} and upper = "
                f"{self.upper}: no number lies between; give a finite one, or exchange the signs."
            )
        if not (self.linear_penalty >= 0.0 and 0.0 <= self.quadratic_penalty < math.inf):
            raise SolverError(
                f"A bound needs linear_penalty >= 0 (infinite: hard) and a finite quadratic_penalty >= 0, got "
                f"{self.linear_penalty} and {self.quadratic_penalty}."
            )
        if self.linear_penalty + self.quadratic_penalty == 0.0:
            raise SolverError(
                "A bound needs a linear_penalty or a quadratic_penalty above 0, got 0 for both: it would bound "
                "nothing; leave it out, or give one."
            )
