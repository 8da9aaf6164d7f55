"""Settings of the physics machine; what it shares with the simulated machine has the same names and meanings."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drawbar.machine.events import ReceiverEvent
from drawbar.machine.sensor_settings import AttitudeSensors, DelaySettings, MastErrors, SensorSettings
from drawbar.machine.settings import ActuatorSettings, HydrostatSettings, LengthFactors, TerrainSettings
from drawbar.machine.steps import demand_whole_steps
from drawbar.settings import Length, NonNegative, NonNegativeLength, Offset, Positive, PositiveAngle, Settings


class TractorBodySettings(Settings):
    """The tractor's masses and wheels."""

    mass: Positive = 700.0
    """of everything, wheels included, kg"""
    ahead: NonNegativeLength = 0.55
    """centre of all mass ahead of the rear axle, m"""
    height: Length = 0.6
    """centre of all mass above level ground, m"""
    track: Length = 1.2
    """between the wheels of the rear axle, m"""
    front_track: Length = 1.1
    """between the wheels of the front axle, m"""
    radius: Length = 0.45
    """of the rear wheels, unloaded, m"""
    front_radius: Length = 0.3
    """of the front wheels, unloaded, m"""
    wheel_mass: Positive = 35.0
    """of one rear wheel, kg"""
    front_wheel_mass: Positive = 18.0
    """of one front wheel, kg"""
    hitch_height: Length = 0.4
    """of the free joint RJ1 above level ground, m"""
    axle_swing: PositiveAngle = math.radians(12.0)
    """how far the front axle swings about the tractor's long axis to either side, rad"""


class TrailerBodySettings(Settings):
    """The trailer's masses and wheels."""

    mass: Positive = 800.0
    """of everything behind RJ2, wheels included, kg"""
    ahead: Offset = 0.1
    """centre of all mass ahead of the axle, m"""
    height: Length = 0.7
    """centre of all mass above level ground, m"""
    track: Length = 1.2
    """between the wheels, m"""
    radius: Length = 0.35
    """of the wheels, unloaded, m"""
    wheel_mass: Positive = 25.0
    """of one wheel, kg"""
    drawbar_mass: Positive = 30.0
    """of the drawbar between RJ1 and RJ2, kg"""


class TyreSettings(Settings):
    """All tyres, see machine/physics/tyres.py."""

    deflection: Annotated[float, Field(ge=0.002, le=0.2)] = 0.012
    """of every tyre under what it carries on level ground, m: a tyre is as stiff as its axle is heavy"""
    damping: Annotated[float, Field(ge=0.0, le=1.0)] = 0.2
    """of bouncing on the tyres, per critical"""
    cornering: Positive = 20.0
    """side force per wheel load and slip angle, and drive force per wheel load and slip, on firm ground, 1/rad; on
    ground that creeps it is 1 / terrain.creep, where that is less"""
    friction: Positive = 0.8
    """largest force along the ground per wheel load"""
    relaxation: Length = 0.3
    """way that a wheel rolls until its slip is built up, on firm ground, m; on ground that creeps it is shorter, as
    `cornering` is less: the carcass stays as stiff"""
    rolling_resistance: NonNegative = 0.03
    """torque that brakes a rolling wheel, per wheel load and radius"""


class SoftTerrainSettings(TerrainSettings):
    """The ground's height, see machine/terrain.py, and how it yields to tyres; the defaults are a firm level plane."""

    creep_speed: NonNegative = 0.0
    """speed at which the side-slip is `creep`, m/s; faster it is as much less, and a vehicle at rest slides; 0: it is
    `creep` at any speed, as on soil"""


class ServoSettings(Settings):
    """How stiffly steering and drive hold what they are asked for."""

    wheel: Positive = 3.0e4
    """of one front wheel, Nm/rad"""
    joint: Positive = 1.0e6
    """of the actuated joint RJ2, Nm/rad"""
    drive: Positive = 5.0e4
    """of the oil between pump and rear axle, Nm/rad"""


class PhysicsMachineSettings(Settings):
    """Everything about the physics machine that is not the vehicle's geometry."""

    kind: Literal["physics"] = "physics"
    step: Annotated[float, Field(ge=1e-3, le=0.05)] = 0.01
    """in which dead time and sensors are resolved; the sample period must be a multiple, s"""
    substeps: Annotated[int, Field(ge=1, le=50)] = 4
    """integration steps of the physics in one such step"""
    actuators: ActuatorSettings = ActuatorSettings()
    hydrostat: HydrostatSettings = HydrostatSettings()
    servos: ServoSettings = ServoSettings()
    lengths: LengthFactors = LengthFactors()
    tractor: TractorBodySettings = TractorBodySettings()
    trailer: TrailerBodySettings = TrailerBodySettings()
    tyres: TyreSettings = TyreSettings()
    terrain: SoftTerrainSettings = SoftTerrainSettings()
    sensors: SensorSettings = SensorSettings()
    masts: MastErrors = MastErrors()
    attitude: AttitudeSensors = AttitudeSensors()
    delays: DelaySettings = DelaySettings()
    events: Annotated[tuple[ReceiverEvent, ...], Field(strict=False)] = ()
    """what happens to the receivers during a run, by kind"""

    @model_validator(mode="after")
    def _dead_time_on_grid(self) -> Self:
        demand_whole_steps("actuators.dead_time", self.actuators.dead_time, self.step)
        return self

    @model_validator(mode="after")
    def _bodies_heavier_than_their_wheels(self) -> Self:
        tractor, trailer = self.tractor, self.trailer
        parts = {
            "tractor": (tractor.mass, 2.0 * (tractor.wheel_mass + tractor.front_wheel_mass) + FRONT_AXLE),
            "trailer": (trailer.mass, 2.0 * trailer.wheel_mass),
        }
        for body, (mass, wheels) in parts.items():
            if not mass > 1.2 * wheels:
                raise ValueError(
                    f"{body}.mass = {mass} kg leaves nothing for its frame beside wheels and axle of {wheels} kg; "
                    f"raise it"
                )
        return self


FRONT_AXLE = 30.0
"""mass of the beam of the front axle, kg"""
