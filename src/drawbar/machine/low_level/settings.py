"""Settings of the low level: the loops' numbers, and those of the simulated valves that they drive."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drawbar.settings import DeadTime, NonNegative, NonNegativeAngle, Positive, PositiveAngle, Settings, Share

_DeadBand = Annotated[float, Field(ge=0.0, lt=1.0)]
_Drive = Annotated[float, Field(gt=0.0, le=1.0)]


class PositionLoopSettings(Settings):
    """One position loop (docs/actuation.md); positions are rad, or strokes of a pedal. Left is "up" for a pedal."""

    proportional: Positive = 3.0
    """K, 1/s"""
    integral: NonNegative = 0.0
    """1/s²; against a leaking cylinder only, and then 0.3 at most"""
    integral_limit: Share = 0.2
    """largest integral part, as a share of the full rate"""
    stop_zone: NonNegativeAngle = math.radians(0.15)
    """largest error at which the drive is 0"""
    dead_band_left: _DeadBand = 0.15
    """drive to the left below which nothing moves"""
    dead_band_right: _DeadBand = 0.15
    """the same to the right"""
    compensation: Share = 0.8
    """share of the dead band that the drive skips; all of it makes a valve reverse for ever"""
    full_rate_left: Positive = math.radians(25.0)
    """rate at the largest drive to the left, per second"""
    full_rate_right: Positive = math.radians(25.0)
    """the same to the right: the areas of a differential cylinder differ"""
    drive_limit: _Drive = 1.0
    """largest drive"""

    @model_validator(mode="after")
    def _dead_band_below_the_limit(self) -> Self:
        if not max(self.dead_band_left, self.dead_band_right) < self.drive_limit:
            raise ValueError(
                f"dead bands {self.dead_band_left} and {self.dead_band_right} must be below drive_limit = "
                f"{self.drive_limit}; nothing would move"
            )
        return self


class SpeedLoopSettings(Settings):
    """The cascade's outer loop: wheel speed to pedal."""

    proportional: NonNegative = 1.0
    """strokes per m/s"""
    integral: NonNegative = 0.5
    """strokes per m/s and second"""
    acceleration: Positive = 0.5
    """of the reference upwards, m/s²"""
    deceleration: Positive = 1.0
    """downwards, m/s²"""
    stopping: Positive = 2.5
    """towards a standstill, m/s²"""
    full_pedal: _Drive = 1.0
    """largest pedal, strokes"""
    moving_pedal: _Drive = 0.2
    """pedal beyond which the wheels must report motion, strokes"""
    patience: Positive = 1.5
    """for how long they may report none, s"""


class ValveSettings(Settings):
    """A proportional valve on a cylinder, as it truly is."""

    dead_band_left: _DeadBand = 0.15
    """drive to the left below which nothing moves"""
    dead_band_right: _DeadBand = 0.15
    """the same to the right"""
    slope_right: Positive = 1.0
    """full rate to the right per that to the left"""
    lag: Positive = 0.1
    """of the rate behind the valve's opening, s"""


class LowLevelSettings(Settings):
    """What is between the commands and the simulated machine's actuators."""

    kind: Literal["lag", "valve"] = "lag"
    """lag: closed loops, simulated as what they amount to; valve: valves and a pedal motor under `drawbar_actuate`"""
    dead_time: DeadTime = 0.04
    """between a drive and the first reaction, a multiple of the integration step, s"""
    sensor_step: PositiveAngle = math.radians(0.1)
    """resolution of the loops' own angle sensors, rad"""
    pedal_step: Positive = 0.002
    """resolution of the pedal's sensor, strokes"""
    speed_step: Positive = 0.02
    """resolution of the wheel's encoder, m/s"""
    front: ValveSettings = ValveSettings()
    """of the front wheels; its full rate is actuators.tractor_rate"""
    joint: ValveSettings = ValveSettings()
    """of the trailer's joint; its full rate is actuators.trailer_rate"""
    front_loop: PositionLoopSettings = PositionLoopSettings()
    joint_loop: PositionLoopSettings = PositionLoopSettings(
        full_rate_left=math.radians(20.0), full_rate_right=math.radians(20.0)
    )
    pedal_loop: PositionLoopSettings = PositionLoopSettings(
        proportional=6.0,
        stop_zone=0.005,
        dead_band_left=0.0,
        dead_band_right=0.0,
        full_rate_left=2.0,
        full_rate_right=2.0,
    )
    """of the pedal, strokes; its true rate is hydrostat.pedal_rate"""
    speed_loop: SpeedLoopSettings = SpeedLoopSettings()
