"""Sensors: how noisily they measure, shared by estimator and simulated machine."""

import math
from typing import Annotated

from pydantic import Field

from drawbar.settings import NonNegative, Positive, PositiveAngle, Settings

AngleDeviation = Annotated[PositiveAngle, Field(ge=1e-5)]
"""Less than any sensor has would make the others weigh nothing."""


class FixSettings(Settings):
    """How far off fixes may be, by what their receivers tell; where they tell nothing it is `sensors.position`."""

    age: Annotated[NonNegative, Field(le=1.0)] = 0.0
    """of a position whose receiver does not tell, s"""
    floor: Positive = 0.01
    """no fix is taken to be better than this, whatever its receiver tells, m"""
    optimism: Annotated[float, Field(ge=1.0)] = 1.5
    """factor on the standard deviation that a receiver tells"""
    floating: Positive = 0.4
    """of a fix in RTK float, m"""
    differential: Positive = 0.8
    """of a differential fix, m"""
    single: Positive = 2.5
    """of a fix without corrections, m"""
    lasting: Annotated[float, Field(ge=1.0)] = 4.0
    """factor on the last three: such errors last for many samples, which do not average them out"""


class SensorNoise(Settings):
    """Standard deviations of the measurements (section IV-A of the paper)."""

    position: Annotated[float, Field(ge=1e-3, le=10.0)] = 0.03
    """each coordinate of both antennas, m"""
    hitch_angle: AngleDeviation = 0.0175
    """beta, rad"""
    speed: Annotated[float, Field(ge=1e-4, le=10.0)] = 0.1
    """wheel speed, m/s"""
    tractor_steering: AngleDeviation = 0.0175
    """delta_t, rad"""
    trailer_steering: AngleDeviation = 0.0175
    """delta_i, rad"""
    yaw: AngleDeviation = math.radians(0.5)
    """of the tractor, where two antennas on it tell it, rad"""
    yaw_rate: AngleDeviation = math.radians(0.5)
    """of the tractor, where a sensor tells it: noise, and what its body turns beside what its wheels say, rad/s"""
    fixes: FixSettings = FixSettings()
