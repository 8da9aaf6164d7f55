"""What the sensors measure and how noisily, shared by models, estimator and simulated machine."""

from typing import Annotated

from pydantic import Field

from drawbar.settings import NonNegative, Positive, PositiveAngle, Settings
from drawbar.vehicle.model import variables

MEASURED = variables(
    tractor_x="m",
    tractor_y="m",
    trailer_x="m",
    trailer_y="m",
    hitch_angle="rad",
    speed="m/s",
    tractor_steering="rad",
    trailer_steering="rad",
)
"""The measured quantities, in the order in which both models of the whole vehicle have them as outputs."""


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

    position: Positive = 0.03
    """each coordinate of both antennas, m"""
    hitch_angle: PositiveAngle = 0.0175
    """beta, rad"""
    speed: Positive = 0.1
    """wheel speed, m/s"""
    tractor_steering: PositiveAngle = 0.0175
    """delta_t, rad"""
    trailer_steering: PositiveAngle = 0.0175
    """delta_i, rad"""
    fixes: FixSettings = FixSettings()
