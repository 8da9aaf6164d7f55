"""Demands of a path on a vehicle: whether its steerings turn far enough, and fast enough, for the curves."""

import math

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats
from drawbar.guidance.path import Path
from drawbar.vehicle.off_tracking import steady_off_tracking
from drawbar.vehicle.parameters import VehicleParameters

STEP = 0.05
"""m between the places where a path is looked at"""
_EXACT = 1e-3
"""m; of a shift"""


def demand_steering(path: Path, vehicle: VehicleParameters, *, speed: float, tolerance: float) -> None:
    """Refuse a path that wants more of the front wheels than they give.

    A wheel angle that is reached too slowly, over a length s instead of at once, shifts an arc of curvature k sideways
    by k s^2 / 24 (as a clothoid in front of it does), even where the steering begins early enough.

    Args:
        path: to be driven.
        vehicle: that drives it.
        speed: set speed, m/s.
        tolerance: sideways shift that is accepted, m.

    Raises:
        PathError: a curve is too tight, or begins or ends too suddenly; names what of the vehicle does not suffice.
    """
    curvature = _curvature(path)
    wheels = _wheels(curvature, vehicle)
    tightest, angle = float(np.abs(curvature).max()), float(np.abs(wheels).max())
    if not angle <= vehicle.tractor_steering_limit:
        raise PathError(
            f"the path's tightest curve, {tightest:.3g} 1/m, needs {angle:.3g} rad ({math.degrees(angle):.1f}°) of the "
            f"front wheels, which vehicle.tractor_steering_limit = {vehicle.tractor_steering_limit:.3g} rad does not "
            f"allow; raise it, or choose a path without curves as tight"
        )
    if not tightest > 0.0:
        return
    reach = _reach(tolerance, tightest)
    needed = _needed_rate(wheels, reach, speed)
    if not needed <= vehicle.tractor_steering_rate:
        raise PathError(
            f"the path's curves need {needed:.2g} rad/s of the front wheels at {speed:g} m/s to stay within "
            f"{tolerance:g} m (guidance.path_tolerance); vehicle.tractor_steering_rate = "
            f"{vehicle.tractor_steering_rate:.2g} rad/s is too slow: raise it, or lower speed"
        )


def steering_shift(path: Path, vehicle: VehicleParameters, *, speed: float, tolerance: float) -> float:
    """Return by how much the front wheels' rate shifts a path's curves sideways, as demand_steering reckons, m.

    Args:
        path: that demand_steering accepts with the same arguments.
        vehicle: that drives it.
        speed: set speed, m/s.
        tolerance: the largest shift that is looked for, m.
    """
    curvature = _curvature(path)
    wheels, tightest = _wheels(curvature, vehicle), float(np.abs(curvature).max())
    if not tightest > 0.0:
        return 0.0
    short, enough = 0.0, tolerance
    while enough - short > _EXACT:
        middle = 0.5 * (short + enough)
        suffices = _needed_rate(wheels, _reach(middle, tightest), speed) <= vehicle.tractor_steering_rate
        short, enough = (short, middle) if suffices else (middle, enough)
    return enough


def largest_off_tracking(path: Path, vehicle: VehicleParameters) -> tuple[float, float]:
    """Return the off-tracking of a path's worst curve, m, and that curve's curvature, 1/m.

    Behind a tractor that is on the path the trailer comes so far beside it, its steering turned as far as it helps. A
    curve counts by its mean curvature over the trailer's length, within which the trailer follows.
    """
    curvature = _curvature(path)
    window = min(len(curvature), max(1, round((vehicle.trailer_length + vehicle.drawbar_length) / STEP)))
    sums = np.concatenate([[0.0], np.cumsum(curvature)])
    means = (sums[window:] - sums[:-window]) / window
    tightest = np.array([means.max(), means.min()])[:: 1 if means.max() >= -means.min() else -1]  # to either side
    tightest = tightest[tightest != 0.0]
    if not len(tightest):
        return 0.0, 0.0
    off_tracking = steady_off_tracking(vehicle, tightest)
    worst = int(off_tracking.argmax())
    return float(off_tracking[worst]), abs(float(tightest[worst]))


def _wheels(curvature: Floats, vehicle: VehicleParameters) -> Floats:
    """Return the front wheels' angles (n,) where the tractor's tracked point is on such curvatures (n,), rad."""
    angles: Floats = np.arctan(_axle_curvature(curvature, *vehicle.tracked.tractor.arm) * vehicle.wheelbase)
    return angles


def _reach(shift: float, curvature: float) -> float:
    """Return the length over which a wheel angle may be reached so that an arc is shifted by no more, m."""
    return max(math.sqrt(24.0 * shift / curvature), STEP)


def _needed_rate(wheels: Floats, reach: float, speed: float) -> float:
    return _largest_change(wheels, round(reach / STEP)) * speed / reach


def _axle_curvature(curvature: Floats, forward: float, left: float) -> Floats:
    """Return the rear axle's curvature where its tracked point is on a curvature (1/m), very large if it cannot."""
    across = np.clip(forward * curvature, -0.999, 0.999)  # sine of the angle to its motion
    inward = np.maximum(left * curvature + np.sqrt(1.0 - across**2), 1e-3)
    axle: Floats = curvature / inward
    return axle


def _curvature(path: Path) -> Floats:
    """Return a path's curvature (n,) in equal steps, 1/m."""
    count = math.ceil(path.length / STEP)
    return path.sample((np.arange(count, dtype=np.float64) + 0.5) * (path.length / count))[:, 3]


def _largest_change(values: Floats, distance: int) -> float:
    """Return the largest difference of two values (n,) that are so many places apart, or all places of a short path."""
    distance = min(distance, len(values) - 1)
    if distance < 1:
        return 0.0
    return float(np.abs(values[distance:] - values[:-distance]).max())
