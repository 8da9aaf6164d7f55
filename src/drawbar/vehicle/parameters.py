"""Parameters of the tractor-trailer system: geometry and limits (figure 3 of the paper)."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drawbar.geometry import arm_offset
from drawbar.settings import Delay, Length, MastHeight, NonNegativeLength, Offset, Positive, PositiveAngle, Settings

SteeringAngle = Annotated[PositiveAngle, Field(lt=math.radians(80.0))]
"""A steering angle that still steers: wheels across the direction of motion do not roll."""

BODIES = ("tractor", "trailer")
"""by which names of signals, settings and columns begin or end"""
STEERINGS = {"tractor": "front wheels", "trailer": "joint"}
"""what a body is steered by, in an operator's words"""
_ASKEW = math.radians(30.0)
MountingAngle = Annotated[float, Field(ge=-_ASKEW, le=_ASKEW, allow_inf_nan=False)]
"""How askew an attitude sensor may be mounted: more is a value in degrees, or a sensor that lies on its side."""


class Mast(Settings):
    """Where an antenna stands, from its body's point on the ground, along the body's axes."""

    forward: Offset = 0.0
    """m"""
    left: Offset = 0.0
    """m"""
    up: MastHeight = 0.0
    """height above the ground; 0: it is not known, and roll and pitch are not corrected for, m"""
    roll_offset: MountingAngle = 0.0
    """what the body's attitude sensor shows as roll while the body stands level, rad"""
    pitch_offset: MountingAngle = 0.0
    """what it shows as pitch, rad"""
    roll_deviation: Annotated[float, Field(ge=0.0, le=math.radians(5.0), allow_inf_nan=False)] = math.radians(0.7)
    """standard deviation of `roll_offset`, which is corrected while driving as far as turns on slopes show it; 0: it is
    exact, rad"""

    @property
    def arm(self) -> tuple[float, float, float]:
        """Forward, left, up, m."""
        return self.forward, self.left, self.up

    def measured_offset(self, yaw: float, roll: float, pitch: float) -> tuple[float, float]:
        """Return how far east and north of its body's point the antenna stands, m.

        Args:
            yaw: of the body, rad.
            roll: that the attitude sensor measures, rad; NaN: the body counts as level.
            pitch: the same.
        """
        lean, tilt = (
            angle if math.isfinite(angle) else 0.0 for angle in (roll - self.roll_offset, pitch - self.pitch_offset)
        )
        return arm_offset(yaw, lean, tilt, self.arm)


class Masts(Settings):
    """Where both antennas stand."""

    tractor: Mast = Mast()
    """from the middle of the rear axle"""
    trailer: Mast = Mast()
    """from the tracked point, `vehicle.trailer_antenna` ahead of the axle"""


class TrackedPoint(Settings):
    """The point of a body that shall be on the line, such as a tool's, from its body's point along the body's axes."""

    forward: Offset = 0.0
    """m"""
    left: Offset = 0.0
    """m"""

    @property
    def arm(self) -> tuple[float, float]:
        """Forward, left, m."""
        return self.forward, self.left


class TrackedPoints(Settings):
    """The points of both bodies that shall be on the line."""

    tractor: TrackedPoint = TrackedPoint()
    """from the middle of the rear axle"""
    trailer: TrackedPoint = TrackedPoint()
    """from the trailer's point, `vehicle.trailer_antenna` ahead of its axle"""

    @property
    def are_the_bodies(self) -> bool:
        """Whether they are the points of the bodies themselves."""
        return not any((*self.tractor.arm, *self.trailer.arm))


class VehicleParameters(Settings):
    """Lengths, steering limits and actuator lag; the defaults are the paper's machine."""

    wheelbase: Length = 1.4
    """L_t, front to rear axle of the tractor, m"""
    hitch_length: Length = 1.1
    """l, tractor rear axle to the actuated joint RJ2 when straight, m"""
    drawbar_length: Length = 0.2
    """d, free joint RJ1 to actuated joint RJ2, m"""
    trailer_length: Length = 1.3
    """L_i, RJ2 to the trailer axle, m"""
    trailer_antenna: NonNegativeLength = 0.25
    """c, the trailer's point ahead of its axle, m; its antenna stands above it unless `masts` places it elsewhere, and
    it is what shall be on the line unless `tracked` names another point"""
    masts: Masts = Masts()
    tracked: TrackedPoints = TrackedPoints()
    joint_sign: Literal[-1, 1] = 1
    """+1: a positive trailer command drives phi - psi positive; -1: the actuator (not the sensor) is reversed"""
    tractor_steering_limit: SteeringAngle = math.radians(30.0)
    """largest |delta_t| that may be commanded, rad"""
    trailer_steering_limit: SteeringAngle = math.radians(20.0)
    """largest |delta_i| that may be commanded, rad"""
    tractor_steering_rate: PositiveAngle = math.radians(25.0)
    """fastest the front wheels turn, rad/s"""
    trailer_steering_rate: PositiveAngle = math.radians(20.0)
    """fastest the actuated joint turns, rad/s"""
    steering_lag: Positive = 0.3
    """tau, time constant of both steering actuators, s"""
    dead_time: Delay = 0.0
    """between a command and the first reaction of any actuator, as far as it is known, s"""
    curvature_limit: Positive = Field(default=0.3)
    """tightest path curvature that the guidance may ask for, 1/m"""

    @model_validator(mode="after")
    def _joints_in_order(self) -> Self:
        if not self.trailer_antenna <= self.trailer_length:
            raise ValueError(
                f"trailer_antenna = {self.trailer_antenna} m is ahead of the actuated joint; it must be "
                f"at most trailer_length = {self.trailer_length} m"
            )
        apart = self.tracked.trailer.left - self.tracked.tractor.left
        reach = self.drawbar_length * math.sin(self.trailer_steering_limit)
        if apart and not abs(apart) <= reach:
            raise ValueError(
                f"tracked.trailer.left = {self.tracked.trailer.left} m is {abs(apart):.3g} m beside "
                f"tracked.tractor.left = {self.tracked.tractor.left} m; the trailer's steering reaches drawbar_length "
                f"sin(trailer_steering_limit) = {reach:.3g} m to either side: bring them nearer to each other, so that "
                f"the tractor runs beside the line too"
            )
        if not self.drawbar_length < self.hitch_length + self.wheelbase:
            raise ValueError(
                f"drawbar_length = {self.drawbar_length} m puts the free joint ahead of the front axle; it must be "
                f"below hitch_length + wheelbase = {self.hitch_length + self.wheelbase} m"
            )
        return self

    @property
    def trailer_point(self) -> float:
        """Distance of the trailer's tracked point ahead of its axle, m."""
        return self.trailer_antenna + self.tracked.trailer.forward

    @property
    def free_joint_offset(self) -> float:
        """Distance a = l - d from the tractor's rear axle back to the free joint RJ1, m."""
        return self.hitch_length - self.drawbar_length
