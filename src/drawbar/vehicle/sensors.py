"""What the sensors measure and how noisily, shared by models, estimator and simulated machine."""

from drawbar.settings import Positive, PositiveAngle, Settings
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
