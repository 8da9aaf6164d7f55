"""Sensors: how noisily they measure, shared by estimator and simulated machine."""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import Field

from drawbar.settings import NonNegative, Positive, PositiveAngle, Settings

AngleDeviation = Annotated[PositiveAngle, Field(ge=1e-5)]
"""Less than any sensor has would make the others weigh nothing."""


class FixSettings(Settings):
    """Standard deviation of fixes by what their receivers report; without a report it is `sensors.position`."""

    former_keys: ClassVar[Mapping[str, str]] = {"optimism": "inflation", "lasting": "correlation_inflation"}
    age: Annotated[NonNegative, Field(le=1.0)] = 0.0
    """of a position whose receiver reports none, s"""
    floor: Positive = 0.01
    """least standard deviation of a fix, whatever its receiver reports, m"""
    inflation: Annotated[float, Field(ge=1.0)] = 1.5
    """factor on the standard deviation that a receiver reports"""
    floating: Positive = 0.4
    """of a fix in RTK float, m"""
    differential: Positive = 0.8
    """of a differential fix, m"""
    single: Positive = 2.5
    """of a fix without corrections, m"""
    correlation_inflation: Annotated[float, Field(ge=1.0)] = 4.0
    """factor on the last three: such errors are correlated over many samples, which do not average them out"""


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
    """of the tractor, where two antennas on it measure it, rad"""
    yaw_rate: AngleDeviation = math.radians(0.5)
    """of the tractor, where a sensor measures it: its noise, and the body's difference from the wheels, rad/s"""
    fixes: FixSettings = FixSettings()
