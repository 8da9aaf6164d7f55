"""Calibration of what is mounted where: the roll sensor's zero from a two-way drive, antenna places from driving."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.hardware.calibrated import Calibrated, blocks, finite_columns, linear_fit

_LARGEST_BIAS = math.radians(10.0)
_BLOCK = 10.0
"""s, over which errors of an RTK position are correlated"""
_TURNING = 0.05
"""least yaw rate that counts as turning, rad/s"""
_USEFUL = 0.05
"""largest deviation of an antenna's place that is of use, m"""


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
        refusals.append(f"{min(map(len, offsets))} times {_BLOCK:.0f} s one way; drive {2.0 * _BLOCK:.0f} s each way")
        return _unknown("rad", "m", refusals)
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
        residual=math.hypot(*errors) / math.sqrt(2.0),
        samples=sum(map(len, offsets)),
        unit="rad",
        residual_unit="m",
        refusals=tuple(refusals),
    )


def _unknown(unit: str, residual_unit: str, refusals: Sequence[str]) -> Calibrated:
    return Calibrated(
        value=math.nan,
        deviation=math.inf,
        residual=math.nan,
        samples=0,
        unit=unit,
        residual_unit=residual_unit,
        refusals=tuple(refusals),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyDrive:
    """A record of one body with its antenna, driven in curves to both sides."""

    times: Floats
    """(n,) s"""
    velocities: Floats
    """(n, 2) of the antenna, east and north, m/s; NaN where there is none"""
    yaws: Floats
    """(n,) of the body up to a constant, rad, continuous: dual antenna, or an integrated gyro without bias"""
    yaw_rates: Floats
    """(n,) rad/s"""
    wheel_speeds: Floats | None
    """(n,) of the wheels on the axle's middle, up to a constant factor, m/s; None: the body has no such sensor"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AntennaPlace:
    """Where an antenna stands on its body, from the axle's middle. Its height is not observable on level ground."""

    forward: Calibrated
    """m"""
    left: Calibrated
    """m; without a wheel speed not observable"""
    yaw_offset: Calibrated
    """yaw of the record less that of the body, with the axle's mean crab angle in it, rad"""
    wheel_factor: Calibrated
    """true speed by reported; without a wheel speed not observable"""


def antenna_place(drive: BodyDrive) -> AntennaPlace:
    """Return where an antenna stands, from velocities alone: no surveyed point is needed.

    The axle's middle moves along the body. An antenna at (f, l) from it moves, in the body's axes, by v - omega l along
    and omega f across. With the yaw known up to a constant c, and a wheel speed up to a factor m:

        along cos c + across sin c = m w - omega l,      across cos c - along sin c = omega f     (c is small)

    f comes from any turning; l and m together need turns to both sides, and c needs straight driving or both sides: a
    turn to one side alone leaves l with m. The height needs roll: see `mounting_roll`, or a tape.
    """
    columns = [drive.times, *drive.velocities.T, drive.yaws, drive.yaw_rates]
    speeds = drive.wheel_speeds
    time, east, north, yaw, rate, *wheel = finite_columns(*columns, *([] if speeds is None else [speeds]))
    refusals = _turning_refusals(time, rate)
    if len(time) < 20:
        nothing = _unknown("m", "m/s", [f"{len(time)} samples; record a minute of curves to both sides"])
        return AntennaPlace(forward=nothing, left=nothing, yaw_offset=nothing, wheel_factor=nothing)
    offset = 0.0
    for _ in range(4):  # the rotation by c is linear about the last c
        along = east * np.cos(yaw - offset) + north * np.sin(yaw - offset)
        across = north * np.cos(yaw - offset) - east * np.sin(yaw - offset)
        fit = linear_fit(np.column_stack([rate, along]), across)
        offset -= float(np.arctan(fit.parameters[1]))
    seconds = max(float(time[-1] - time[0]), 1.0)
    correction = math.sqrt(max(1.0, len(time) / seconds))  # a receiver's velocity errors last about a second
    forward = _found(fit.parameters[0], fit.deviations[0] * correction, fit.residual, seconds, "m", refusals)
    yaw_offset = _found(offset, fit.deviations[1] * correction, fit.residual, seconds, "rad", refusals)
    if not wheel:
        reason = "without a wheel speed of this body its antenna's place to the side is not observable; measure it"
        left, factor = _unknown("m", "m/s", [reason]), _unknown("1", "m/s", [reason])
    else:
        side = linear_fit(np.column_stack([-rate, wheel[0]]), along)
        left = _found(side.parameters[0], side.deviations[0] * correction, side.residual, seconds, "m", refusals)
        factor = _found(side.parameters[1], side.deviations[1] * correction, side.residual, seconds, "1", refusals)
    return AntennaPlace(forward=forward, left=left, yaw_offset=yaw_offset, wheel_factor=factor)


def _turning_refusals(time: Floats, rate: Floats) -> list[str]:
    """Refuse records in which turns and straights do not tell what is to be told apart."""
    if len(time) < 2:
        return []
    step = np.diff(time, append=time[-1])
    refusals = []
    for side, name in ((1.0, "left"), (-1.0, "right")):
        seconds = float(step[side * rate > _TURNING].sum())
        if seconds < 10.0:
            refusals.append(f"{seconds:.0f} s of turning {name} faster than {_TURNING} rad/s; drive 10 s at least")
    return refusals


def _found(
    value: float, deviation: float, residual: float, seconds: float, unit: str, refusals: Sequence[str]
) -> Calibrated:
    reasons = list(refusals)
    if unit == "m" and not deviation <= _USEFUL:
        reasons.append(f"its deviation of {deviation:.2f} m is above {_USEFUL} m; drive longer, in tighter curves")
    return Calibrated(
        value=float(value),
        deviation=float(deviation),
        residual=residual,
        samples=int(seconds),
        unit=unit,
        residual_unit="m/s",
        refusals=tuple(reasons),
    )
