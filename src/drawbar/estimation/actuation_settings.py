"""Settings of actuation: how dead times, lags and rates of the steerings are found, and what earlier drives found."""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import Field

from drawbar.settings import NonNegative, Positive, PositiveAngle, Settings


class SteeringMemory(Settings):
    """What earlier drives found of one steering. Its search begins there instead of at what is stated."""

    dead_time: Annotated[NonNegative, Field(le=0.8)] | None = None
    """of the steering; below `actuation.guess` the guess counts, s"""
    lag: Positive | None = None
    """of the steering, s"""
    rate: PositiveAngle | None = None
    """of the steering; above the stated one that counts, rad/s"""


class SteeringMemories(Settings):
    """What earlier drives of this vehicle found of both steerings; `drawbar calibrate` writes it."""

    tractor: SteeringMemory = SteeringMemory()
    trailer: SteeringMemory = SteeringMemory()


class ActuationSettings(Settings):
    """What is found of the steerings' dead times, lags and rates during the run (docs/theory/identification.md)."""

    former_keys: ClassVar[Mapping[str, str]] = {"odd": "residual"}

    identify: bool = False
    """find them, and plan with what was found; else they are what the vehicle section states"""
    guess: Annotated[NonNegative, Field(le=0.8)] = 0.2
    """what the dead time is taken for until something shows it, unless `vehicle.dead_time` is more: to overstate it
    costs little, s"""
    guess_deviation: Positive = 0.15
    """of that guess, s"""
    body_lag_per_speed: Annotated[NonNegative, Field(le=0.1)] = 0.02
    """with `identify`: by how much the tractor turns later than its wheels stand, per speed, on firm ground, s²/m;
    tyres and inertia cause it, and no steering sensor shows it. Ground that creeps adds what the estimator knows of it,
    a yaw-rate sensor what it shows; the front wheels count as later by the sum. 0: by nothing, on any ground"""
    lag_deviation: Positive = 0.7
    """of the logarithm of the lags about `vehicle.steering_lag`, before something shows them"""
    memory: Positive = 60.0
    """time in which what was seen is forgotten, s"""
    repeats: Positive = 5.0
    """how many errors in a row agree"""
    resolution: PositiveAngle = math.radians(0.3)
    """standard deviation of the measured steering angles, of their rounding for one, rad"""
    residual: PositiveAngle = 0.1
    """error of a steering angle that no dead time and no lag explain, or motion that its sensor does not show: the
    sensor, the actuator or a driver, rad"""
    patience: Positive = 1.0
    """for how long it may last before the run ends, s"""
    settling: Positive = 1.0
    """time constant with which the dead time, lags and rates that are planned with follow what is known, s"""
    remembered: SteeringMemories = SteeringMemories()
