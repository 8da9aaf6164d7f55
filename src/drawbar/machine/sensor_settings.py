"""Settings of the simulated sensors: their errors, where they truly stand, and how late they are."""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import Field

from drawbar.settings import Angle, NonNegative, NonNegativeAngle, Offset, Positive, PositiveAngle, Settings
from drawbar.vehicle.sensors import SensorNoise

_NOISE = SensorNoise()


class SensorSettings(Settings):
    """Errors of the sensors, standard deviations."""

    position: NonNegative = _NOISE.position
    """white part of each coordinate, m"""
    position_drift: NonNegative = 0.0
    """correlated part of each coordinate (first-order Gauss-Markov), m"""
    drift_time: Positive = 60.0
    """correlation time of the drift, s"""
    hitch_angle: NonNegativeAngle = _NOISE.hitch_angle
    """rad"""
    speed: NonNegative = _NOISE.speed
    """m/s"""
    steering: NonNegativeAngle = 0.0
    """of both steering angles, before they are rounded, rad"""
    steering_resolution: PositiveAngle = math.radians(1.0)
    """both steering angles are rounded to multiples of this, rad"""
    quality: bool = False
    """the receivers report quality and standard deviation of a fix"""


class MastError(Settings):
    """True position of an antenna minus the one of `vehicle.masts`, along its body's axes."""

    forward: Offset = 0.0
    """m"""
    left: Offset = 0.0
    """m"""
    up: Offset = 0.0
    """m"""


class MastErrors(Settings):
    """True positions of both antennas minus those of `vehicle.masts`."""

    tractor: MastError = MastError()
    trailer: MastError = MastError()


class AttitudeSensorSettings(Settings):
    """The attitude sensor of one body: roll, pitch, yaw rate."""

    present: bool = False
    """without it all three are missing"""
    noise: NonNegativeAngle = math.radians(0.3)
    """white part of roll and pitch, standard deviation, rad"""
    roll_bias: Angle = 0.0
    """constant part of the roll: the sensor is mounted askew, rad"""
    pitch_bias: Angle = 0.0
    """constant part of the pitch, rad"""
    yaw_rate_noise: NonNegativeAngle = math.radians(0.3)
    """white part of the yaw rate, of which the trailer's is recorded only, standard deviation, rad/s"""
    yaw_rate_bias: Angle = 0.0
    """constant part of the yaw rate, rad/s"""


class YawSensorSettings(Settings):
    """A receiver with two antennas on the tractor, which measures its yaw."""

    present: bool = False
    """without it the yaw is missing"""
    noise: NonNegativeAngle = math.radians(0.3)
    """white part, standard deviation, rad"""
    bias: Angle = 0.0
    """constant part: the antennas' line is not the one that is stated, rad"""


class AttitudeSensors(Settings):
    """The attitude sensors of both bodies."""

    tractor: AttitudeSensorSettings = AttitudeSensorSettings()
    trailer: AttitudeSensorSettings = AttitudeSensorSettings()
    yaw: YawSensorSettings = YawSensorSettings()
    """of the tractor, as old as the rest"""


class Delay(Settings):
    """How old what a sensor reports is."""

    latency: Annotated[NonNegative, Field(le=1.0)] = 0.0
    """constant part, s"""
    jitter: Annotated[NonNegative, Field(le=0.5)] = 0.0
    """standard deviation of what comes on top, never below an age of zero, s"""


class DelaySettings(Settings):
    """How old what the sensors report is."""

    former_keys: ClassVar[Mapping[str, str]] = {"told": "reported"}

    fix: Delay = Delay()
    """of both positions"""
    hitch_angle: Delay = Delay()
    speed: Delay = Delay()
    steering: Delay = Delay()
    """of both steering angles"""
    attitude: Delay = Delay()
    """of both bodies' roll, pitch and yaw rate, and the tractor's yaw"""
    reported: bool = True
    """the measurement holds the age of its values"""
