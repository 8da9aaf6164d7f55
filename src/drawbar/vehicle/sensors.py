"""What the sensors measure and how noisily, shared by models, estimator and simulated machine."""

from typing import Annotated

from pydantic import Field

from drawbar.settings import PositiveAngle, Settings
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


AngleDeviation = Annotated[PositiveAngle, Field(ge=1e-5)]
"""Less than any sensor has would make the others weigh nothing."""


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
