"""Zero of a wheel-angle sensor from recorded driving (docs/calibration.md)."""

from collections.abc import Sequence

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.calibration.calibrated import Calibrated, blocks, finite_columns, linear_fit

SLOW, FAST = 0.3, 3.0
"""m/s, between which a calibration is driven"""
STRAIGHT = 1e-3
"""largest mean |curvature| of a straight drive, 1/m"""
STRAIGHT_WAY = 30.0
"""least length of one, m"""
BLOCK = 1.0
"""s, of which the mean is one sample"""


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
        refusal = f"{len(mean)} s at {SLOW} to {FAST} m/s; drive {STRAIGHT_WAY:.0f} m straight at 1 to 2 m/s"
        return Calibrated.unknown("counts", [refusal])
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
        unit="counts",
        refusals=tuple(refusals),
    )
