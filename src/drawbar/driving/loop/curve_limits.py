"""Curve limits: what the gate leaves of the front wheels' angle at the set speed, and whether it suffices for a path.

The gate bounds their angle by the lateral acceleration at the measured speed (safety/envelope.py). The controller
plans within the same bound, so that nominal driving is not limited, and a path that needs more is refused before.
"""

import math

import numpy as np

from drawbar.config import SLOWEST, Configuration
from drawbar.errors import PathError
from drawbar.guidance.demands import STEP
from drawbar.guidance.path import Path
from drawbar.safety.envelope import Bounds, Envelope

_FASTER = 0.3
"""by which the measured speed may exceed the set speed, m/s: noise, slip, a driver's foot"""
_CORRECTIONS = math.radians(3.5)
"""what a curve must leave of the wheels' angle for corrections, rad; with less the controller cannot hold its line"""


def within_envelope(configuration: Configuration) -> Configuration:
    """Return the configuration with its front wheels limited to what the gate allows a little above the set speed."""
    limit = _cap(configuration)
    vehicle = configuration.vehicle.model_copy(update={"tractor_steering_limit": limit})
    return configuration.model_copy(update={"vehicle": vehicle})


def demand_slow_curves(path: Path, configuration: Configuration) -> None:
    """Refuse a path with a curve that is too tight for the set speed.

    Raises:
        PathError: names which curve, what it needs, what the gate allows, and how fast it may be driven.
    """
    vehicle, speed, cap = configuration.vehicle, configuration.speed, _cap(configuration)
    places = np.arange(0.0, path.length, STEP)
    curvature = np.abs(path.sample(places)[:, 3])
    tightest = float(curvature.max())
    needed = math.atan(tightest * vehicle.wheelbase) + _CORRECTIONS
    if needed <= cap or cap >= vehicle.tractor_steering_limit:
        return
    acceleration = configuration.safety.envelope.lateral_acceleration
    slower = math.sqrt(acceleration * vehicle.wheelbase / math.tan(needed)) - _FASTER
    highest = math.floor(20.0 * slower) / 20.0
    remedy = f"set speed to at most {highest:.2f} m/s" if highest >= SLOWEST else "no speed will do; raise that limit"
    raise PathError(
        f"the curve of {1.0 / tightest:.1f} m radius at {places[curvature.argmax()]:.0f} m of the path needs "
        f"{math.degrees(needed):.1f}° of the front wheels, {math.degrees(_CORRECTIONS):.1f}° of them for corrections; "
        f"at speed = {speed:g} m/s the gate allows {math.degrees(cap):.1f}°, by safety.envelope.lateral_acceleration = "
        f"{acceleration:g} m/s²: {remedy}, or choose a path whose curves are wider"
    )


def _cap(configuration: Configuration) -> float:
    """Return the largest angle of the front wheels that is never limited in nominal driving, rad."""
    vehicle = configuration.vehicle
    bounds = Bounds(
        wheelbase=vehicle.wheelbase,
        tractor_limit=vehicle.tractor_steering_limit,
        trailer_limit=vehicle.trailer_steering_limit,
    )
    return Envelope(configuration.safety, bounds).angle_cap(configuration.speed + _FASTER)
