"""Calibration of a wheel-angle sensor from recorded driving: range, direction and zero (docs/calibration.md)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.hardware.calibrated import Calibrated, blocks, finite_columns, linear_fit

SLOW, FAST = 0.3, 3.0
"""m/s, between which a calibration is driven"""
STRAIGHT = 1e-3
"""largest mean |curvature| of a straight drive, 1/m"""
STRAIGHT_WAY = 30.0
"""least length of one, m"""
BLOCK = 1.0
"""s, of which the mean is one sample"""
_ENDS_AGREE = 0.05
"""share of the range by which the ends of two sweeps may differ"""
_LEAST_RANGE = 50
"""of a sensor, in its own steps"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorRange:
    """What two sweeps from lock to lock tell of a sensor."""

    lowest: float
    """counts at one lock"""
    highest: float
    """counts at the other"""
    direction: int
    """1: counts rise to the left, -1: they fall; 0: unknown"""
    noise: float
    """standard deviation at rest, counts"""
    resolution: float
    """smallest step, counts"""
    refusals: tuple[str, ...]


def sensor_range(sweep: Sequence[float] | Floats, rest: Sequence[float] | Floats) -> SensorRange:
    """Return a sensor's range, direction and noise.

    Args:
        sweep: (n,) counts while the operator turns from the middle to the left lock, to the right, and both once more.
        rest: (m,) counts while nothing moves.
    """
    (counts,), (still,) = finite_columns(sweep), finite_columns(rest)
    if len(counts) < 20 or len(still) < 20:
        reason = f"{len(counts)} samples of the sweep and {len(still)} at rest; record 20 of each at least"
        return SensorRange(
            lowest=math.nan, highest=math.nan, direction=0, noise=math.nan, resolution=math.nan, refusals=(reason,)
        )
    lowest, highest, noise = float(counts.min()), float(counts.max()), float(still.std(ddof=1))
    steps = np.diff(np.unique(np.concatenate([counts, still])))
    resolution = float(steps.min()) if len(steps) else math.inf
    visits = _visits(counts, lowest, highest)
    direction = {"high": 1, "low": -1}.get(visits[0], 0) if visits else 0
    refusals = list(_range_refusals(highest - lowest, noise, resolution, visits))
    return SensorRange(
        lowest=lowest,
        highest=highest,
        direction=direction,
        noise=noise,
        resolution=resolution,
        refusals=tuple(refusals),
    )


def _visits(counts: Floats, lowest: float, highest: float) -> list[str]:
    """Return which ends were reached, in order."""
    near = _ENDS_AGREE * (highest - lowest)
    ends = ["low" if each <= lowest + near else "high" for each in counts if not lowest + near < each < highest - near]
    return [end for i, end in enumerate(ends) if i == 0 or end != ends[i - 1]]


def _range_refusals(span: float, noise: float, resolution: float, visits: list[str]) -> Sequence[str]:
    reasons = []
    if not span >= _LEAST_RANGE * resolution:
        reasons.append(f"the sensor moved by {span:.4g} counts only, in steps of {resolution:.4g}; check its lever")
    if not noise <= 0.01 * span:
        reasons.append(f"the sensor's noise at rest, {noise:.3g} counts, is above 1 % of its range; check its cable")
    if len(visits) < 4:
        reasons.append(
            f"the same locks were not reached twice to {_ENDS_AGREE:.0%} of the range; turn from the middle to the "
            f"left lock, to the right, and both once more, each until it stops"
        )
    return reasons


def zero_from_straight(
    times: Sequence[float] | Floats,
    counts: Sequence[float] | Floats,
    yaw_rates: Sequence[float] | Floats,
    speeds: Sequence[float] | Floats,
) -> Calibrated:
    """Return the counts at which the vehicle drives straight.

    Counts are fitted as a straight line over the curvature (yaw rate by speed), means of one second each; its value at
    curvature 0 is the zero, so that a driver who weaves a little does no harm. A constant side slope or a biased yaw
    rate shifts it: drive on level ground, and take the yaw rate from positions or from a gyro whose bias was removed.

    Args:
        times: (n,) s.
        counts: (n,) of the sensor.
        yaw_rates: (n,) rad/s, counter-clockwise.
        speeds: (n,) m/s.
    """
    time, count, rate, speed = finite_columns(times, counts, yaw_rates, speeds)
    moving = (np.abs(speed) >= SLOW) & (np.abs(speed) <= FAST)
    way = float((np.abs(speed[1:]) * np.diff(time))[moving[1:]].sum()) if len(time) > 1 else 0.0
    mean, curvature = blocks(time[moving], count[moving], rate[moving] / speed[moving], length=BLOCK)
    if len(mean) < 5:
        return Calibrated(
            value=math.nan,
            deviation=math.inf,
            residual=math.nan,
            samples=len(mean),
            unit="counts",
            residual_unit="counts",
            refusals=(f"{len(mean)} s at {SLOW} to {FAST} m/s; drive {STRAIGHT_WAY:.0f} m straight at 1 to 2 m/s",),
        )
    columns = [np.ones(len(mean))] + ([curvature] if curvature.std() > 1e-6 else [])
    fit = linear_fit(np.column_stack(columns), mean)
    refusals = []
    if way < STRAIGHT_WAY:
        refusals.append(f"{way:.0f} m were driven; drive {STRAIGHT_WAY:.0f} m at least")
    if not abs(curvature.mean()) <= STRAIGHT:
        refusals.append(f"the mean curvature is {curvature.mean():.2g} 1/m; drive straighter, {STRAIGHT:g} at most")
    return Calibrated(
        value=float(fit.parameters[0]),
        deviation=float(fit.deviations[0]),
        residual=fit.residual,
        samples=len(mean),
        unit="counts",
        residual_unit="counts",
        refusals=tuple(refusals),
    )
