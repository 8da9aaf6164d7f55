"""Identification of a tube's bounds from a recorded run: what the declared sources would have been at every sample.

The one-step error of the nominal model, r = e^+ - (A e^) - B (u - ū), is G w + eps+ - A eps (without A e^ where the
nominal state starts at the estimate). Where the truth is known, so is eps, and as many disturbances as there are states
explain the rest. On a real machine the parts cannot be separated, and all of r is the increment of the estimate.
"""

from dataclasses import dataclass

import numpy as np

from drawbar.control.settings import Nominal
from drawbar.control.tube.error_model import ErrorModel
from drawbar.geometry import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Identified:
    """What one declared bound would have had to be, sample by sample."""

    section: str
    """of the body's settings: disturbances, estimation or increments"""
    name: str
    unit: str
    magnitudes: Floats
    """(k,)"""


def identified(
    model: ErrorModel,
    explaining: tuple[str, ...],
    nominal: Nominal,
    *,
    deviations: Floats,
    corrections: Floats,
    estimate_errors: Floats,
) -> tuple[Identified, ...]:
    """Return the bounds that a run of k samples asks for.

    Args:
        model: of the body.
        explaining: n disturbances that together can explain any error.
        nominal: predicted or propagated; an optimised nominal state leaves no one-step error behind.
        deviations: x^ - x̄ (k, n); a row of zeros where the nominal state was reset.
        corrections: u - ū (k,), rad.
        estimate_errors: eps (k, n), NaN where the truth is not known.
    """
    A, B = model.A[0], model.B[0]
    kept = A if nominal is Nominal.PROPAGATED else np.zeros_like(A)
    residuals = deviations[1:] - deviations[:-1] @ kept.T - np.outer(corrections[:-1], B)
    residuals = np.where(deviations[1:].any(axis=1, keepdims=True), residuals, np.nan)
    increments = estimate_errors[1:] - estimate_errors[:-1] @ A.T
    if np.isnan(estimate_errors).all():
        return _named("increments", model.states, model.units, residuals)
    acting = [model.disturbances.index(name) for name in explaining]
    disturbances = np.linalg.solve(model.G[0][:, acting], (residuals - increments).T).T
    units = tuple(model.disturbance_units[i] for i in acting)
    return (
        *_named("disturbances", explaining, units, disturbances),
        *_named("estimation", model.states, model.units, estimate_errors),
        *_named("increments", model.states, model.units, increments),
    )


def _named(section: str, names: tuple[str, ...], units: tuple[str, ...], values: Floats) -> tuple[Identified, ...]:
    """Return one of each column, of the rows without a NaN."""
    rows = np.abs(values[np.isfinite(values).all(axis=1)])
    return tuple(
        Identified(section=section, name=name, unit=unit, magnitudes=column)
        for name, unit, column in zip(names, units, rows.T, strict=True)
    )
