"""A calibrated number: value, standard deviation, and why it may not be used; and what all fits share."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from drawbar.geometry import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibrated:
    """One number that a calibration found."""

    value: float
    """in `unit`; NaN: not observable from these records"""
    deviation: float
    """standard deviation of the value"""
    unit: str
    refusals: tuple[str, ...] = ()
    """why it is not to be used, each with what to do; empty: use it"""

    @classmethod
    def unknown(cls, unit: str, refusals: Sequence[str]) -> Self:
        """Return what stands for a number that the records do not determine."""
        return cls(value=math.nan, deviation=math.inf, unit=unit, refusals=tuple(refusals))

    @property
    def accepted(self) -> bool:
        """Whether it may be used."""
        return not self.refusals

    @property
    def text(self) -> str:
        """Value and deviation, to the deviation's second digit."""
        if not 0.0 < self.deviation < math.inf:
            return f"{self.value:.4g} ± {self.deviation:.2g}"
        digits = max(1 - math.floor(math.log10(self.deviation)), 0)
        return f"{self.value:.{digits}f} ± {self.deviation:.{digits}f}"


def finite_columns(*columns: Sequence[float] | Floats) -> list[Floats]:
    """Return columns (n,) of equal length as arrays, without the rows in which any is not finite."""
    arrays = [np.asarray(column, float) for column in columns]
    whole = np.logical_and.reduce([np.isfinite(array) for array in arrays])
    return [array[whole] for array in arrays]


def blocks(times: Floats, *columns: Floats, length: float) -> list[Floats]:
    """Return the means of columns over consecutive blocks of time, (m,) each.

    Errors of receivers and gyros are correlated over a second and more: means of blocks are what counts as a sample.
    """
    if not len(times):
        return [np.zeros(0) for _ in columns]
    index = np.floor((times - times[0]) / length).astype(int)
    _, place, count = np.unique(index, return_inverse=True, return_counts=True)
    full = count >= 0.5 * np.median(count)
    return [(np.bincount(place, column) / count)[full] for column in columns]


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearFit:
    """Least squares y = A p."""

    parameters: Floats
    deviations: Floats
    """standard deviations, from the residual; infinite where A does not determine a parameter"""
    residual: float
    """root mean square, with the degrees of freedom taken off"""


def linear_fit(matrix: Floats, values: Floats) -> LinearFit:
    """Return the least squares solution of matrix (m, n) x = values (m,); undetermined entries deviate infinitely."""
    rows, columns = matrix.shape
    scale = np.sqrt((matrix**2).sum(axis=0))
    scale[scale == 0.0] = 1.0
    _, sizes, directions = np.linalg.svd(matrix / scale, full_matrices=False)
    parameters = np.linalg.lstsq(matrix / scale, values, rcond=1e-10)[0]
    left = values - matrix / scale @ parameters
    residual = math.sqrt(float(left @ left) / (rows - columns)) if rows > columns else math.inf
    undetermined = sizes <= 1e-10 * max(sizes.max(initial=0.0), 1e-300)
    inverse = np.where(undetermined, math.inf, 1.0 / np.where(undetermined, 1.0, sizes))
    with np.errstate(invalid="ignore"):
        spread = np.nan_to_num(np.abs(directions.T) * inverse, nan=0.0, posinf=math.inf)
    deviations = max(residual, 1e-300) * np.sqrt((spread**2).sum(axis=1)) / scale
    return LinearFit(parameters=parameters / scale, deviations=deviations, residual=residual)
