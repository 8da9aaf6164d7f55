"""Wiggle judgement: whether a steering follows its commands, from what was commanded and measured. Pure."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.calibration.calibrated import finite_columns, linear_fit

WIGGLE_GAIN = (0.7, 1.3)
WIGGLE_DELAY = 0.5
"""s"""
_LONGEST_DELAY = 0.8
"""that a wiggle test looks for, below half of its own period, s"""
_EXPLAINED = 0.7
"""share of the motion that the command must explain in a wiggle test"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wiggle:
    """What a wiggle test saw."""

    gain: float
    """measured per commanded; negative: reversed"""
    delay: float
    """dead time and lag, s"""
    explained: float
    """share of the measured motion's variance that command, gain and delay explain"""
    refusals: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether the steering may be engaged."""
        return not self.refusals


def wiggle_command(time: float, *, amplitude: float = math.radians(2.0), duration: float = 1.0) -> float:
    """Return the set point of a wiggle test, added to the present angle: left, right, back, rad.

    Args:
        time: since its begin, s; it lasts three durations.
        amplitude: rad.
        duration: of each, s.
    """
    return amplitude if 0.0 <= time < duration else -amplitude if duration <= time < 2.0 * duration else 0.0


def wiggle_test(
    times: Sequence[float] | Floats, commanded: Sequence[float] | Floats, measured: Sequence[float] | Floats
) -> Wiggle:
    """Judge a wiggle test: sign, gain from 0.7 to 1.3, delay of 0.5 s at most.

    measured = gain * lagged(commanded) + constant by least squares, lagged by the dead time and the first-order lag,
    0.8 s together at most, that fit best: a loop that has only just arrived when it is turned back has not too small a
    gain.

    Args:
        times: (n,) s, in order, half a second before the wiggle and a second after it included.
        commanded: (n,) set points, rad.
        measured: (n,) angles, rad.
    """
    time, command, angle = finite_columns(times, commanded, measured)
    if len(time) < 20 or not np.all(np.diff(time) > 0.0) or not np.ptp(command) > 0.0:
        reason = f"samples: {len(time)}, commands over {np.ptp(command) if len(command) else 0.0} rad; repeat it"
        return Wiggle(gain=math.nan, delay=math.nan, explained=0.0, refusals=(reason,))
    variation = float(((angle - angle.mean()) ** 2).sum())
    best = Wiggle(gain=0.0, delay=math.nan, explained=0.0, refusals=())
    for lag in np.arange(0.0, _LONGEST_DELAY, 0.05).tolist():
        smooth = _lagged(time, command, lag)
        for dead_time in np.arange(0.0, _LONGEST_DELAY - lag, 0.02).tolist():
            shifted = np.interp(time - dead_time, time, smooth)
            fit = linear_fit(np.column_stack([shifted, np.ones(len(time))]), angle)
            left = fit.residual**2 * (len(time) - 2)
            explained = 1.0 - left / variation if variation > 0.0 else 0.0
            if explained > best.explained:
                gain = float(fit.parameters[0])
                best = Wiggle(gain=gain, delay=lag + dead_time, explained=explained, refusals=())
    return replace(best, refusals=_wiggle_refusals(best.explained, best.gain, best.delay))


def _lagged(times: Floats, values: Floats, lag: float) -> Floats:
    """Return what a first-order lag makes of values that are held from sample to sample."""
    if lag == 0.0:
        return values
    shares = -np.expm1(-np.diff(times) / lag)
    made = values.copy()
    for i, share in enumerate(shares.tolist(), 1):
        made[i] = made[i - 1] + share * (values[i - 1] - made[i - 1])
    return made


def _wiggle_refusals(explained: float, gain: float, delay: float) -> tuple[str, ...]:
    if not abs(gain) >= 0.1:
        return (f"the wheels moved by {abs(gain):.0%} of the command; check hydraulics, switch and cable of the valve",)
    if not explained >= _EXPLAINED:
        return (f"the command explains {explained:.0%} of the motion; hold still, at 0.3 m/s and above, and repeat",)
    if gain < 0.0:
        return ("the wheels turn to the other side; calibrate the sensor's direction and the valve's",)
    reasons = []
    if not WIGGLE_GAIN[0] <= gain <= WIGGLE_GAIN[1]:
        reasons.append(f"gain {gain:.2f} is outside {WIGGLE_GAIN[0]} to {WIGGLE_GAIN[1]}; calibrate the sensor's scale")
    if not delay <= WIGGLE_DELAY:
        reasons.append(f"the delay of {delay:.2f} s is above {WIGGLE_DELAY} s; check the loop's gain and the oil")
    return tuple(reasons)
