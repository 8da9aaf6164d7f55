"""The sensors' noise, shared by the estimator's weights and the simulated machine."""

from drawbar.settings import Positive, PositiveAngle, Settings


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
