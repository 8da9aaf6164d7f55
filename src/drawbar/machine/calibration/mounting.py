"""Mounting calibration: the roll sensor's zero from a two-way drive, antenna places from driving."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from drawbar.geometry import Floats
from drawbar.machine.calibration.calibrated import Calibrated, blocks, finite_columns

_LARGEST_BIAS = math.radians(10.0)
_BLOCK = 10.0
"""s, over which errors of an RTK position are correlated"""
BACK = 2.0 * _BLOCK
"""least time of each of two ways, s"""
TURNING = 0.05
"""least yaw rate that counts as turning, rad/s"""
_USEFUL = 0.05
"""largest deviation of an antenna's place that is of use, m"""
_STRETCH = 6.0
"""s, over which the wheels measure how the tractor has moved: long enough for a curve, too short for slip to add up"""
_GOES = 1.0
"""least distance from its begin that a stretch reaches, m: more than a standing antenna seems to"""
_FEWEST = 8
"""stretches"""
_ALIKE = 5
"""stretches one after the other on ground of one kind, where the wheels slip alike"""
_EXPLAINED = 0.08
"""largest rms of what the wheels leave of the track, m"""


def mounting_roll(
    there: tuple[Sequence[float] | Floats, Sequence[float] | Floats],
    back: tuple[Sequence[float] | Floats, Sequence[float] | Floats],
    *,
    height: float,
) -> Calibrated:
    """Return the mounting roll of an attitude sensor, to be taken off its roll, rad.

    The same wheel tracks are driven both ways. A roll that reads too large by b puts the ground point u sin b too far
    to the left of the way driven, on the other side of the line when coming back: the means differ by 2 u sin b. A side
    slope cancels: its true roll is corrected for. An antenna off the middle by l does not, it counts as 2 l in the
    difference: take it out of the positions before.

    Args:
        there: times (n,) s, and cross-track errors (n,) m of the roll-corrected ground point, left of the way there
            positive.
        back: the same, the errors still left of the way *there*.
        height: u of the antenna above the ground, m.
    """
    means = [blocks(*finite_columns(*way), length=_BLOCK)[0:] for way in (there, back)]
    offsets = [each[0] for each in means]
    refusals = []
    if not (math.isfinite(height) and height >= 0.5):
        refusals.append(f"the antenna's height {height} m is below 0.5 m; measure it above the ground")
    if min(map(len, offsets)) < 2:
        refusals.append(f"{min(map(len, offsets))} times {_BLOCK:.0f} s one way; drive {BACK:.0f} s each way")
        return Calibrated.unknown("rad", refusals)
    difference = float(offsets[0].mean() - offsets[1].mean())
    errors = [float(each.std(ddof=1)) for each in offsets]
    deviation = math.hypot(*(error / math.sqrt(len(each)) for error, each in zip(errors, offsets, strict=True)))
    share = difference / (2.0 * height) if height > 0.0 else math.nan
    bias = math.asin(share) if abs(share) <= 1.0 else math.nan
    if not abs(bias) <= _LARGEST_BIAS:
        refusals.append(
            f"the ways lie {difference:.2f} m apart, more than {math.degrees(_LARGEST_BIAS):.0f}° of mounting roll; "
            f"was it the same track, and is the antenna's offset to the side taken out?"
        )
    return Calibrated(
        value=bias,
        deviation=deviation / (2.0 * height) if height > 0.0 else math.inf,
        unit="rad",
        refusals=tuple(refusals),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveDrive:
    """A record of the tractor, driven in curves to both sides; n samples, NaN where there is none."""

    times: Floats
    """(n,) s"""
    x: Floats
    """(n,) of the antenna, east, without what roll moves it, m"""
    y: Floats
    """(n,) north"""
    wheel_speeds: Floats
    """(n,) m/s, up to a constant factor"""
    front_wheels: Floats
    """(n,) rad, up to an offset, and a factor for each side"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AntennaPlace:
    """Where the tractor's antenna stands, from the rear axle's middle. Its height is not observable on level ground."""

    forward: Calibrated
    """m"""
    left: Calibrated
    """m"""


def antenna_place(drive: CurveDrive, *, wheelbase: float) -> AntennaPlace:
    """Return where the tractor's antenna stands, from driving alone: no surveyed point is needed.

    In stretches of 6 s the wheels tell how the rear axle's middle has moved, up to place and direction:

        yaw' = m w tan(k (delta + b)) / L,      place' = m w (cos yaw, sin yaw)

    with a k for each side. The antenna at (f, l) swings out where that turns. f, l and the wheels' own m, k, b are
    those by which these stretches, each laid upon the measured one as well as it can be, leave the least. An estimate
    of the yaw would be of no use: it has been made with the place that is looked for. f comes from going into and out
    of curves, l from curves to both sides.

    Args:
        drive: two minutes of S-curves, to one side and the other in 8 s or less.
        wheelbase: L, m.
    """
    time, *columns = finite_columns(drive.times, drive.x, drive.y, drive.wheel_speeds, drive.front_wheels)
    stretches = _stretches(time, columns[0] + 1j * columns[1])
    if len(stretches) < _FEWEST:
        nothing = Calibrated.unknown(
            "m", [f"{len(stretches) * _STRETCH:.0f} s of driving; drive two minutes of S-curves"]
        )
        return AntennaPlace(forward=nothing, left=nothing)
    times, x, y, speeds, angles = (column[stretches] for column in (time, *columns))
    place, deviations, residual = _fit(times, x + 1j * y, speeds, angles, wheelbase)
    refusals = _turning_refusals((speeds * np.tan(angles) / wheelbase).ravel(), times.shape[1])
    if not residual <= _EXPLAINED:
        refusals.append(
            f"the wheels explain the track to {residual:.2f} m only, {_EXPLAINED} m at most; calibrate the front "
            f"wheels first, and drive where they do not slip"
        )
    return AntennaPlace(
        forward=_found(place[0], deviations[0], refusals),
        left=_found(place[1], deviations[1], refusals),
    )


def _fit(
    times: Floats, measured: NDArray[Any], speeds: Floats, angles: Floats, wheelbase: float
) -> tuple[Floats, Floats, float]:
    """Return f and l that explain the tracks (k, m) best, their standard deviations, and the rms of what is left, m."""

    def left_over(parameters: Floats) -> Floats:
        speed, to_left, to_right, offset, forward, left = parameters
        scaled = np.where(angles + offset > 0.0, to_left, to_right) * (angles + offset)
        rates = speed * speeds * np.tan(scaled) / wheelbase
        turn = np.exp(1j * _integral(times, rates))
        track = _integral(times, speed * speeds * turn) + (forward + 1j * left) * turn
        gap = _laid_upon(track, measured) - measured
        return np.concatenate([gap.real.ravel(), gap.imag.ravel()])

    first, sizes = (1.0, 1.0, 1.0, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 0.1, 1.0, 1.0)
    fit = least_squares(left_over, first, x_scale=sizes, loss="soft_l1", f_scale=0.05)
    residual = float(np.sqrt(np.mean(left_over(fit.x) ** 2)))
    covariance = np.linalg.pinv(fit.jac.T @ fit.jac)
    per_second = times.shape[1] / _STRETCH  # errors of a position last a second and more
    white = residual**2 * max(per_second, 1.0) * np.diag(covariance)
    pulls = np.einsum("akmp,akm->kp", fit.jac.reshape(2, *times.shape, -1), fit.fun.reshape(2, *times.shape))
    deviations = np.sqrt(np.maximum(white, np.diag(covariance @ _lasting(pulls) @ covariance)))
    return fit.x[4:], deviations[4:], residual


def _lasting(pulls: Floats) -> Floats:
    """Return the covariance of the sum of what stretches (k, p) pull at p parameters: neighbours slip alike.

    Of the sums over groups of neighbours (White 1980; Liang and Zeger 1986).
    """
    starts = np.arange(0, len(pulls), _ALIKE)
    groups = np.add.reduceat(pulls, starts, axis=0)
    found: Floats = groups.T @ groups * (len(starts) / max(len(starts) - 1, 1))
    return found


def _stretches(time: Floats, places: NDArray[Any]) -> NDArray[np.int64]:
    """Return the samples (k, m) of all stretches without a gap in which the antenna went somewhere."""
    if len(time) < 2:
        return np.zeros((0, 2), int)
    count = max(2, round(_STRETCH / max(float(np.median(np.diff(time))), 1e-3)))
    starts = [
        start
        for start in range(0, len(time) - count + 1, count)
        if time[start + count - 1] - time[start] <= 1.1 * _STRETCH
        and np.abs(places[start : start + count] - places[start]).max() >= _GOES
    ]
    return np.array([np.arange(start, start + count) for start in starts]).reshape(-1, count)


def _integral(times: Floats, values: NDArray[Any]) -> NDArray[Any]:
    """Return the integral of values (k, m) from each row's begin on."""
    steps = 0.5 * (values[:, 1:] + values[:, :-1]) * np.diff(times, axis=1)
    return np.concatenate([np.zeros((len(values), 1)), np.cumsum(steps, axis=1)], axis=1)


def _laid_upon(track: NDArray[Any], measured: NDArray[Any]) -> NDArray[Any]:
    """Return each row of complex places moved and turned so that it lies upon the measured one best."""
    off, seen = (each - each.mean(axis=1, keepdims=True) for each in (track, measured))
    turn = np.angle((seen * off.conj()).sum(axis=1, keepdims=True))
    moved: NDArray[Any] = off * np.exp(1j * turn) + measured.mean(axis=1, keepdims=True)
    return moved


def _turning_refusals(rate: Floats, count: int) -> list[str]:
    """Refuse records whose curves to both sides are too short to separate what is to be found."""
    step = _STRETCH / count
    refusals = []
    for side, name in ((1.0, "left"), (-1.0, "right")):
        seconds = step * int((side * rate > TURNING).sum())
        if seconds < 10.0:
            refusals.append(f"{seconds:.0f} s of turning {name} faster than {TURNING} rad/s; drive 10 s at least")
    return refusals


def _found(value: float, deviation: float, refusals: Sequence[str]) -> Calibrated:
    reasons = list(refusals)
    if not deviation <= _USEFUL:
        reasons.append(
            f"its deviation of {deviation:.2f} m is above {_USEFUL} m; drive longer, in tighter and quicker S-curves"
        )
    return Calibrated(
        value=float(value),
        deviation=float(deviation),
        unit="m",
        refusals=tuple(reasons),
    )
