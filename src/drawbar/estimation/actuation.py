"""Actuation: dead times, lags and rates of both steerings, found during the run (actuation.h, lag_bank.h)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drawbar.codegen import Unit
from drawbar.estimation.actuation_settings import ActuationSettings, SteeringMemory
from drawbar.geometry import Floats
from drawbar.vehicle.parameters import VehicleParameters

_DEAD_TIMES, _LAGS, _RATES, _PAST = 17, 12, 10, 426
"""as in lag_bank.h"""
_STEP = 0.05
"""s; between two dead times of the bank, or less"""
_FASTEST, _RATIO = 0.08, 1.3
"""first lag of the bank, s, and of each to the one before"""
_SLOWER = 1.2
"""of each rate of the bank to the next, which is slower"""
_PRIOR_RATE = 6.0
"""logarithm of the odds for the stated or remembered rate against each other: a few seconds of clear evidence"""


def actuation_unit(vehicle: VehicleParameters, settings: ActuationSettings, sample_time: float) -> Unit:
    """Return what finds dead times, lags and rates, and makes commands for the stated lag ones for the lag found.

    Args:
        vehicle: stated lag, rates, limits and dead time of the actuators.
        settings: of the search.
        sample_time: s.
    """
    priors = (
        _prior(vehicle, settings, settings.remembered.tractor, vehicle.tractor_steering_rate),
        _prior(vehicle, settings, settings.remembered.trailer, vehicle.trailer_steering_rate),
    )
    values: dict[str, ArrayLike] = {
        "limits": (vehicle.tractor_steering_limit, vehicle.trailer_steering_limit),
        "sign": vehicle.joint_sign,
        "sample_time": sample_time,
        "settling": -np.expm1(-sample_time / settings.settling),
        "residual": settings.residual,
        "patience": settings.patience,
        "dead_time": max(each.dead_time for each in priors),
        "lags": [each.lag for each in priors],
        "rates": [each.rate for each in priors],
        **_grid(settings, sample_time),
        **_bank("FRONT_WHEELS", vehicle, settings, priors[0], vehicle.tractor_steering_rate),
        **_bank("TRAILER_JOINT", vehicle, settings, priors[1], vehicle.trailer_steering_rate),
    }
    return Unit(name="actuation", source='#include "actuation.h"', configure=lambda workspace: workspace.write(values))


def bank_lags() -> Floats:
    """Return the lags (n,) of the bank's members, s."""
    lags: Floats = _FASTEST * np.power(_RATIO, np.arange(_LAGS), dtype=np.float64)
    return lags


def bank_rates() -> Floats:
    """Return the rates (n,) of the bank's members, as logarithms of shares of the stated rate."""
    rates: Floats = -np.log(_SLOWER) * np.arange(_RATES, dtype=np.float64)
    return rates


def _grid(settings: ActuationSettings, sample_time: float) -> dict[str, ArrayLike]:
    """Return what both banks share: dead times and lags of their members, and how they are judged."""
    parts = max(1, round(sample_time / _STEP))
    part = sample_time / parts
    delays = max(1, min(round(_STEP / part), (_PAST - parts) // _DEAD_TIMES)) * np.arange(_DEAD_TIMES)
    lags = bank_lags()
    return {
        "grid.part": part,
        "grid.parts": parts,
        "grid.delays": delays,
        "grid.dead_times": part * delays,
        "grid.lags": lags,
        "grid.shares": -np.expm1(-part / lags),
        "grid.slower": bank_rates(),
        "grid.memory": np.exp(-sample_time / settings.memory),
        "grid.repeats": settings.repeats,
        "grid.between": np.square((part * delays[1], np.log(_RATIO), np.log(_SLOWER))) / 12.0,
        "grid.resolution": settings.resolution,
        "grid.prior_dead_time_deviation": settings.guess_deviation,
        "grid.prior_lag_deviation": settings.lag_deviation,
        "grid.prior_rate": _PRIOR_RATE,
    }


def _bank(
    name: str, vehicle: VehicleParameters, settings: ActuationSettings, prior: "_Prior", stated_rate: float
) -> dict[str, ArrayLike]:
    """Return what one steering's bank begins with; stated_rate: of that steering, rad/s."""
    known: dict[str, ArrayLike] = {
        "stated_lag": vehicle.steering_lag,
        "stated_rate": stated_rate,
        "prior_dead_time": prior.dead_time,
        "prior_lag": prior.lag,
        "prior_rate": prior.rate,
        "rate": prior.rate,
        "rate_deviation": prior.rate * np.log(_SLOWER) / np.sqrt(12.0),
        "dead_time": prior.dead_time,
        "dead_time_deviation": settings.guess_deviation,
        "lag": prior.lag,
        "lag_deviation": settings.lag_deviation * prior.lag,
    }
    return {f"banks[{name}].{key}": value for key, value in known.items()}


@dataclass(frozen=True, slots=True)
class _Prior:
    """What a steering is taken for until something shows it."""

    dead_time: float
    """s"""
    lag: float
    """s"""
    rate: float
    """rad/s"""


def _prior(
    vehicle: VehicleParameters, settings: ActuationSettings, remembered: SteeringMemory, stated_rate: float
) -> _Prior:
    """Return the prior of one steering: what is remembered where it is slower than the guess and what is stated."""
    return _Prior(
        dead_time=max(vehicle.dead_time, settings.guess, remembered.dead_time or 0.0),
        lag=max(vehicle.steering_lag, remembered.lag or 0.0),
        rate=min(remembered.rate or stated_rate, stated_rate),
    )
