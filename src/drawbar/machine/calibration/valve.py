"""Valve calibration: from recorded pushes of a steering actuator its dead band, full rate, lag, dead time."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from drawbar.geometry import Floats
from drawbar.machine.calibration.calibrated import Calibrated, finite_columns, linear_fit

MOVED = math.radians(0.3)
"""what counts as having moved, rad"""
QUANTILE = 0.2
"""of the dead bands of several runs, that is taken: too small a dead band costs accuracy, too large a one oscillates"""
RUNS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class PushRecord:
    """What a sensor reported of one push: a constant drive from rest, and what came after it."""

    drive: float
    """-1 to 1"""
    duration: float
    """for which the drive was held, s"""
    times: Floats
    """(n,) from the begin of the push, s"""
    angles: Floats
    """(n,) from where it began, rad"""

    @property
    def moved(self) -> float:
        """Return how far it moved in all, rad."""
        return float(self.angles[-1]) if len(self.angles) else math.nan


def dead_band(runs: Sequence[Sequence[PushRecord]]) -> Calibrated:
    """Return the dead band to one side, as a share of the full drive.

    Each run raises the drive by 1 % from push to push, each from rest and of the same duration, until some pushes have
    moved more than 0.3°. Beyond the dead band the motion of a push is proportional to what the drive exceeds it by, lag
    and dead time included, so that the straight line through the pushes that moved meets zero at the dead band: the
    drive at which motion is first seen lies some percent above it. Of several runs the 20 % quantile is taken.

    The value is the dead band itself; `compensation` of the loop is the share of it that is skipped (0.8).
    """
    bands, deviations = [], []
    for run in runs:
        moving = [push for push in run if abs(push.moved) > MOVED]
        if len(moving) < 3:
            continue
        drives, moves = np.array([abs(push.drive) for push in moving]), np.array([abs(push.moved) for push in moving])
        fit = linear_fit(np.column_stack([moves, np.ones(len(moves))]), drives)
        bands.append(float(fit.parameters[1]))
        deviations.append(float(fit.deviations[1]))
    if not bands:
        return _no_dead_band((f"in no run did three pushes move more than {math.degrees(MOVED)}°; push further",))
    refusals = []
    if len(bands) < RUNS:
        refusals.append(f"runs that moved: {len(bands)}, needed: {RUNS}")
    value = float(np.quantile(bands, QUANTILE))
    spread = float(np.std(bands, ddof=1)) if len(bands) > 1 else math.inf
    if not (0.0 <= value < 0.6):
        refusals.append(f"a dead band of {value:.0%} cannot be; check the valve's supply and the sensor")
    if len(bands) > 1 and not spread <= 0.05:
        refusals.append(f"the runs differ by {spread:.1%} of the drive; warm the oil up, and repeat")
    return Calibrated(
        value=max(value, 0.0),
        deviation=math.hypot(spread, float(np.mean(deviations))),
        unit="of the full drive",
        refusals=tuple(refusals),
    )


def _no_dead_band(refusals: tuple[str, ...]) -> Calibrated:
    return Calibrated.unknown("of the full drive", refusals)


@dataclass(frozen=True, slots=True, kw_only=True)
class Dynamics:
    """How an actuator, or a closed loop, answers a step."""

    size: Calibrated
    """of an actuator its rate at full drive, rad/s; of a closed loop its gain"""
    lag: Calibrated
    """s"""
    dead_time: Calibrated
    """s"""


def actuator_dynamics(pushes: Sequence[PushRecord], *, dead_band: float) -> Dynamics:
    """Return full rate, lag and dead time of an actuator to one side, from large pushes on a rolling vehicle.

    angle(t) = r u (s - tau (1 - exp(-s / tau))), s = t - T > 0, u = (|drive| - d) / (1 - d), while the drive is held.

    Args:
        pushes: three or more, all to the same side.
        dead_band: d of this side, share of the full drive.
    """

    def shape(push: PushRecord) -> Callable[[Floats, float], Floats]:
        opening = math.copysign((abs(push.drive) - dead_band) / (1.0 - dead_band), push.drive)
        return lambda since, lag: opening * (since + lag * np.expm1(-since / lag))

    return _dynamics(pushes, shape, unit="rad/s", most_lag=1.0)


def _dynamics(
    pushes: Sequence[PushRecord],
    shape: Callable[[PushRecord], Callable[[Floats, float], Floats]],
    *,
    unit: str,
    most_lag: float,
) -> Dynamics:
    """Fit size, lag and dead time, common to all pushes, by least squares over the time in which the drive is held."""
    held = [_held(push) for push in pushes]
    shapes = [shape(push) for push in pushes]
    values = np.concatenate([angles for _, angles in held]) if held else np.zeros(0)

    def predicted(parameters: Floats) -> Floats:
        size, lag, dead_time = parameters
        return np.concatenate(
            [
                size * each(np.maximum(times - dead_time, 0.0), lag)
                for each, (times, _) in zip(shapes, held, strict=True)
            ]
        )

    if len(pushes) < RUNS or len(values) < 10:
        reason = f"pushes: {len(pushes)}, with samples: {len(values)}; make {RUNS}, with 10 samples a second or more"
        return _dynamics_of(np.full(3, math.nan), np.full(3, math.inf), unit, (reason,))
    bounds = ([0.0, 1e-3, 0.0], [math.inf, most_lag, 0.5])
    starts = [least_squares(lambda p: predicted(p) - values, (0.5, lag, 0.05), bounds=bounds) for lag in (0.05, 0.3)]
    fit = min(starts, key=lambda start: start.cost)
    residual = math.sqrt(2.0 * fit.cost / (len(values) - 3))
    spread = np.linalg.pinv(fit.jac.T @ fit.jac)
    # of angles quantised by their sensor, whose errors are not independent from sample to sample: twice
    deviations = 2.0 * residual * np.sqrt(np.diag(spread))
    reasons = _dynamics_refusals(fit.x, values, residual)
    return _dynamics_of(fit.x, deviations, unit, reasons)


def _held(push: PushRecord) -> tuple[Floats, Floats]:
    times, angles = finite_columns(push.times, push.angles)
    within = times <= push.duration
    return times[within], angles[within]


def _dynamics_refusals(fitted: Floats, values: Floats, residual: float) -> tuple[str, ...]:
    reasons = []
    motion = float(np.ptp(values))
    if not motion >= 10.0 * MOVED:
        reasons.append(f"the angle moved by {math.degrees(motion):.1f}°; push longer, to 3° at least")
    if not residual <= 0.1 * motion:
        reasons.append(f"the fit leaves {math.degrees(residual):.2f}°; the pushes differ, or the wheels hit their stop")
    if not fitted[0] > 1e-3:
        reasons.append("the angle does not follow the drive; find the drive's direction first")
    return tuple(reasons)


def _dynamics_of(fitted: Floats, deviations: Floats, unit: str, refusals: tuple[str, ...]) -> Dynamics:
    size, lag, dead_time = (
        Calibrated(
            value=float(value),
            deviation=float(deviation),
            unit=each,
            refusals=refusals,
        )
        for value, deviation, each in zip(fitted, deviations, (unit, "s", "s"), strict=True)
    )
    return Dynamics(size=size, lag=lag, dead_time=dead_time)
