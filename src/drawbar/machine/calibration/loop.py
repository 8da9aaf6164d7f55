"""Loop calibration: a closed loop's dead band, how far a steering stays from its set point. Pure.

Boards and valves that take set points close the loop themselves. Where their smallest drive does not move the steering
yet, it rests until the set point is far enough away.
"""

import math
from dataclasses import dataclass

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.calibration.calibrated import Calibrated, finite_columns

_SAME = math.radians(0.06)
"""angles that differ by less are the same, rad; a sensor's steps are finer"""
_REST = 0.3
"""for which it rests before it counts, s"""
_SLOW = math.radians(2.0)
"""fastest set point of which the error at the beginning of a motion is evaluated, rad/s"""
_GOES_ON = 1.0
"""within which a motion has gone four times as far as where it is seen, s"""
_FEWEST = 6
"""motions from rest"""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopDrive:
    """What was asked of a steering while it was steered, and what it did; n samples, NaN where there is none."""

    times: Floats
    """(n,) of the measured angles, s"""
    asked: Floats
    """(n,) set points, rad"""
    measured: Floats
    """(n,) rad"""


def loop_dead_band(drive: LoopDrive) -> Calibrated:
    """Return how far the set point must be away until a resting steering moves to it, rad.

    Each motion from rest, while the set point moves slowly, shows it once: the error at which it began. The value is
    their median.
    """
    time, asked, measured = finite_columns(drive.times, drive.asked, drive.measured)
    errors = np.array(_at_begin_of_motion(time, asked, measured))
    refusals = []
    if len(errors) < _FEWEST:
        refusals.append(
            f"motions from rest: {len(errors)}, needed: {_FEWEST}; let drawbar steer slow curves for two minutes (a "
            f"steering that never rests has no dead band)"
        )
    spread = float(errors.std(ddof=1)) if len(errors) > 1 else math.inf
    return Calibrated(
        value=float(np.median(errors)) if len(errors) else math.nan,
        deviation=spread / math.sqrt(max(len(errors), 1)) + _SAME / 2.0,
        unit="rad",
        refusals=tuple(refusals),
    )


def _at_begin_of_motion(time: Floats, asked: Floats, measured: Floats) -> list[float]:
    """Return the amounts of the errors with which motions towards the set point began from rest."""
    found: list[float] = []
    begin = 0  # of the present rest
    for k in range(1, len(time)):
        if time[k] - time[k - 1] > _REST:  # nothing was received
            begin = k
        elif abs(measured[k] - measured[begin]) > _SAME:
            rest = float(np.mean(measured[begin:k]))
            onset = _onset(time[k - 1 :], np.abs(measured[k - 1 :] - rest))
            if onset - time[begin] >= _REST:
                at_begin, at_onset = np.interp((time[begin], onset), time, asked)
                towards = (at_onset - rest) * (measured[k] - rest) > 0.0
                if towards and abs(at_onset - at_begin) <= _SLOW * (onset - time[begin]):
                    found.append(abs(float(at_onset - rest)))
            begin = k
    return found


def _onset(time: Floats, moved: Floats) -> float:
    """Return when a motion began that is just seen; -inf: it did not continue.

    While the set point continues evenly, speed grows evenly from zero, and the way with the square of the time: four
    times the way takes twice the time.
    """
    times = []
    for way in (_SAME, 4.0 * _SAME):
        beyond = np.flatnonzero(moved > way)
        if not len(beyond) or time[beyond[0]] - time[0] > _GOES_ON:
            return -math.inf
        k = max(int(beyond[0]), 1)
        times.append(float(np.interp(way, moved[k - 1 : k + 1], time[k - 1 : k + 1])))
    return 2.0 * times[0] - times[1]
