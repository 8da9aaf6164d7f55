"""Statistics over seeds: mean and 95 % interval (Student 1908, *The probable error of a mean*)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.special import stdtrit

_UPPER = 0.975
"""quantile of Student's distribution that bounds the middle 95 %"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Statistic:
    """Of one figure over the seeds, in the figure's unit."""

    mean: float
    half_width: float
    """of the 95 % interval of the mean; NaN for a single seed"""
    largest: float
    count: int

    @classmethod
    def of(cls, values: Sequence[float]) -> Self:
        """Summarise one value per seed; a missing one (NaN) makes everything NaN, as none do."""
        sample = np.asarray(values, float)
        count = len(sample)
        if not count:
            return cls(mean=math.nan, half_width=math.nan, largest=math.nan, count=0)
        half_width = math.nan
        if count > 1:
            half_width = float(stdtrit(count - 1, _UPPER) * sample.std(ddof=1) / math.sqrt(count))
        return cls(mean=float(sample.mean()), half_width=half_width, largest=float(sample.max()), count=count)

    def text(self, digits: int = 1) -> str:
        """Return mean ± half width of the interval; a dash where there is no mean."""
        if math.isnan(self.mean):
            return "–"
        spread = "" if math.isnan(self.half_width) else f" ± {self.half_width:.{digits}f}"
        return f"{self.mean:z.{digits}f}{spread}"
