"""Scale of a wheel-angle sensor: counts to angle, by circles driven with the steering held."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drawbar.errors import ConfigurationError
from drawbar.geometry import Floats
from drawbar.machine.calibration.calibrated import Calibrated, blocks, finite_columns, linear_fit
from drawbar.machine.calibration.zero import BLOCK, SLOW
from drawbar.protocols.sensors import InductiveSensor

Span = tuple[float, float]
LARGEST_RESIDUAL = math.radians(1.0)
"""of the fit of a scale, rad"""
_CIRCLES = 3
"""angles to each side, at least"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Circle:
    """A record of driving with the steering held."""

    times: Floats
    """(n,) s"""
    counts: Floats
    """(n,)"""
    yaw_rates: Floats
    """(n,) rad/s, counter-clockwise"""
    speeds: Floats
    """(n,) of the rear axle's middle, m/s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """What circles to both sides show of a sensor."""

    counts_per_degree: Calibrated
    """of a straight line through all circles; negative where counts fall to the left"""
    polynomial: InductiveSensor | None
    """of degree 3 at most; None where it has no inverse or leaves too much"""
    points: tuple[tuple[float, float, float], ...]
    """(counts, angle (rad), its deviation) of each circle"""


def scale_from_circles(circles: Sequence[Circle], *, wheelbase: float, zero: Calibrated, span: Span) -> Scale:
    """Return a sensor's scale by delta = atan(L omega / v) of circles at 3 angles to each side or more.

    What comes out is the angle of a bicycle that drives these circles: on ground where the front wheels slip it is
    smaller than the wheels' own, in proportion, and that is what the controllers' model wants on this ground.

    Args:
        circles: records of some seconds each, the steering held.
        wheelbase: L, m.
        zero: counts when driving straight.
        span: lowest and highest counts.
    """
    points = sorted(_circle_point(circle, wheelbase) for circle in circles)
    counts, angles, deviations = (
        (np.array(column) for column in zip(*points, strict=True)) if points else [np.zeros(0)] * 3
    )
    refusals = _scale_refusals(angles, deviations, zero)
    offset = counts - zero.value
    overall = _slope(offset, angles, refusals)
    polynomial = _polynomial(counts, angles, zero, span) if overall.accepted else None
    if overall.accepted and polynomial is None:
        reason = (
            f"no polynomial of degree 3 leaves less than {math.degrees(LARGEST_RESIDUAL):.0f}° of these circles and "
            f"has an inverse; hold the steering in each circle, and check the sensor's lever for play"
        )
        overall = replace(overall, refusals=(reason,))
    return Scale(
        counts_per_degree=overall,
        polynomial=polynomial,
        points=tuple(points),
    )


def _circle_point(circle: Circle, wheelbase: float) -> tuple[float, float, float]:
    """Return counts, angle and the angle's standard deviation of one circle."""
    time, count, rate, speed = finite_columns(circle.times, circle.counts, circle.yaw_rates, circle.speeds)
    moving = np.abs(speed) >= SLOW
    angle = np.arctan(wheelbase * rate[moving] / speed[moving])
    means, angles = blocks(time[moving], count[moving], angle, length=BLOCK)
    if len(means) < 3:
        return (math.nan, math.nan, math.inf)
    return float(means.mean()), float(angles.mean()), float(angles.std(ddof=1) / math.sqrt(len(angles)))


def _scale_refusals(angles: Floats, deviations: Floats, zero: Calibrated) -> list[str]:
    refusals = [f"the zero is not to be used: {reason}" for reason in zero.refusals]
    for side, name in ((1.0, "left"), (-1.0, "right")):
        there = int((side * angles > math.radians(3.0)).sum())
        if there < _CIRCLES:
            refusals.append(f"{there} circles to the {name} above 3°; drive {_CIRCLES} of different angles")
    if not np.all(np.isfinite(deviations)):
        refusals.append(f"a circle has less than 3 s at {SLOW} m/s and above; drive it longer")
    return refusals


def _slope(offset: Floats, angles: Floats, refusals: list[str]) -> Calibrated:
    """Return counts per degree of a line through the zero."""
    whole = np.isfinite(offset) & np.isfinite(angles)
    if not whole.any():
        return Calibrated.unknown("counts per degree", refusals)
    fit = linear_fit(offset[whole, None], angles[whole])
    slope = float(fit.parameters[0])
    if slope == 0.0:
        return Calibrated.unknown(
            "counts per degree", [*refusals, "the counts do not follow the angle; check the sensor"]
        )
    value = math.radians(1.0) / slope
    return Calibrated(
        value=value,
        deviation=abs(value / slope) * float(fit.deviations[0]),
        unit="counts per degree",
        refusals=tuple(refusals),
    )


def _polynomial(counts: Floats, angles: Floats, zero: Calibrated, span: Span) -> InductiveSensor | None:
    """Return the polynomial of the lowest degree that leaves no more than the residual allowed."""
    lowest, highest = span
    middle, half = 0.5 * (lowest + highest), 0.5 * (highest - lowest)
    x = np.append((counts - middle) / half, (zero.value - middle) / half)
    y = np.append(angles, 0.0)
    for degree in (1, 2, 3):
        fit = linear_fit(np.vander(x, degree + 1, increasing=True), y)
        if not fit.residual <= LARGEST_RESIDUAL:
            continue
        normal = np.polynomial.Polynomial([*fit.parameters])
        coefficients = normal(np.polynomial.Polynomial([-middle / half, 1.0 / half])).coef
        padded = [*map(float, coefficients), 0.0, 0.0, 0.0][:4]
        try:
            return InductiveSensor(
                coefficients=(padded[0], padded[1], padded[2], padded[3]),
                lowest=lowest,
                highest=highest,
                deviation=fit.residual,
            )
        except ConfigurationError:
            continue
    return None
