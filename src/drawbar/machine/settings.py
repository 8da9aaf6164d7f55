"""Settings of the simulated machine; the defaults are those of docs/theory/simulated-machine.md."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, ValidationError, model_validator

from drawbar.errors import ConfigurationError
from drawbar.machine.events import Crab, Event, SlipFactor
from drawbar.machine.low_level.settings import LowLevelSettings
from drawbar.machine.sensor_settings import AttitudeSensors, DelaySettings, MastErrors, SensorSettings
from drawbar.machine.steps import demand_whole_steps
from drawbar.settings import (
    Angle,
    DeadTime,
    Length,
    NonNegative,
    NonNegativeAngle,
    Positive,
    PositiveAngle,
    Settings,
    Speed,
)
from drawbar.vehicle.parameters import VehicleParameters


class ActuatorSettings(Settings):
    """The two PI-controlled steering cylinders."""

    tractor_rate: PositiveAngle = math.radians(25.0)
    """largest |delta_t'|, rad/s"""
    trailer_rate: PositiveAngle = math.radians(20.0)
    """largest |delta_i'|, rad/s"""
    tractor_stop: PositiveAngle = math.radians(35.0)
    """mechanical stop of the front wheels, rad"""
    trailer_stop: PositiveAngle = math.radians(31.7)
    """mechanical stop of the actuated joint, rad"""
    dead_time: DeadTime = 0.0
    """between a command and the first reaction of any actuator, a multiple of the integration step, s"""
    lag_factor: Positive = 1.0
    """true lag of both cylinders per the one that `vehicle.steering_lag` states"""


class PidGains(Settings):
    """Gains of one PID loop; the derivative acts on the measured value only."""

    proportional: Positive
    """output per error"""
    integral: NonNegative
    """output per error and second"""
    derivative: NonNegative
    """output per rate of the measured value, s"""


class HydrostatSettings(Settings):
    """Hydrostatic drive: a motor moves the pedal, the pedal sets the wheel speed; a cascade of two PIDs."""

    full_speed: Speed = 3.0
    """wheel speed at full pedal, and the largest that may be commanded, m/s"""
    speed_lag: Positive = 0.5
    """wheel speed behind pedal, s"""
    pedal_rate: Positive = 2.0
    """largest speed of the pedal, full strokes per second"""
    pedal_lag: Positive = 0.05
    """pedal speed behind its command, s"""
    speed_loop: PidGains = PidGains(proportional=1.0 / 3.0, integral=2.0 / 3.0, derivative=0.02)
    """outer loop, m/s to pedal strokes"""
    pedal_loop: PidGains = PidGains(proportional=8.0, integral=4.0, derivative=0.1)
    """inner loop, pedal strokes to strokes per second"""


class SlipProcess(Settings):
    """A slip factor wandering as an Ornstein-Uhlenbeck process, reflected at 0 and 1: wheels only lose."""

    mean: SlipFactor
    """about which it wanders; 1: no slip"""
    deviation: Annotated[float, Field(ge=0.0, le=0.2)]
    """stationary standard deviation, before the reflection"""
    time_constant: Positive = 20.0
    """s"""


class CrabProcess(Settings):
    """A side-slip angle that wanders as an Ornstein-Uhlenbeck process."""

    mean: Crab = 0.0
    """rad"""
    deviation: Annotated[NonNegativeAngle, Field(lt=0.1)] = math.radians(0.4)
    """stationary standard deviation, rad"""
    time_constant: Positive = 5.0
    """s"""


class GroundSettings(Settings):
    """How the wheels slip."""

    longitudinal_slip: SlipProcess = SlipProcess(mean=0.95, deviation=0.02)
    """mu, ground speed per wheel speed"""
    tractor_slip: SlipProcess = SlipProcess(mean=0.92, deviation=0.03)
    """kappa, effective per actual steering angle"""
    steering_offset: Crab = 0.0
    """b, constant error of the steering angle's zero, rad"""
    tractor_crab: CrabProcess = CrabProcess()
    """alpha_r, of the tractor's rear axle"""
    trailer_crab: CrabProcess = CrabProcess()
    """alpha_i, of the trailer's axle"""


class TerrainSettings(Settings):
    """The ground's height, see machine/terrain.py; the defaults are a plane without slope."""

    slope: Annotated[NonNegativeAngle, Field(lt=0.5)] = 0.0
    """rad"""
    downhill: Angle = -0.5 * math.pi
    """where the slope falls to, counter-clockwise from east, rad"""
    creep: Annotated[float, Field(ge=0.0, le=2.0)] = 0.0
    """side-slip of every axle per angle of the slope across it, 1; soft ground: 0.36"""
    unevenness: NonNegative = 0.0
    """standard deviation of the height about the slope, m"""
    shortest: Positive = 2.0
    """wavelengths of the unevenness, whose power is spread evenly from this one, m"""
    longest: Positive = 20.0
    """to this one, m"""

    @model_validator(mode="after")
    def _wavelengths_in_order(self) -> Self:
        if not self.shortest <= self.longest:
            raise ValueError(
                f"shortest = {self.shortest} m must not be above longest = {self.longest} m; exchange them"
            )
        return self

    @property
    def is_flat(self) -> bool:
        """Whether both bodies always stand level."""
        return self.slope == 0.0 and self.unevenness == 0.0


class BodySettings(Settings):
    """How both bodies stand on the ground, see machine/attitude.py."""

    tractor_track: Length = 1.2
    """between the wheels of the rear axle, m"""
    trailer_track: Length = 1.2
    """between the trailer's wheels, m"""
    tractor_suspension: Positive = 0.1
    """time constant with which roll and pitch follow the ground, s"""
    trailer_suspension: Positive = 0.1
    """time constant with which roll and pitch follow the ground, s"""


class LengthFactors(Settings):
    """True lengths per those that the vehicle section states: the tape measure was wrong."""

    wheelbase: Positive = 1.0
    """of L_t"""
    hitch_length: Positive = 1.0
    """of l"""
    drawbar_length: Positive = 1.0
    """of d"""
    trailer_length: Positive = 1.0
    """of L_i"""

    def applied_to(self, vehicle: VehicleParameters) -> VehicleParameters:
        """Return the vehicle as it truly is, everything but these lengths as stated.

        Raises ConfigurationError when no vehicle has such lengths.
        """
        stated = vehicle.model_dump()
        lengths = {name: factor * stated[name] for name, factor in self}
        try:
            return VehicleParameters.model_validate(stated | lengths)
        except ValidationError as error:
            reasons = "; ".join(each["msg"] for each in error.errors())
            raise ConfigurationError(
                f"machine.lengths makes the true vehicle impossible ({reasons}); bring its factors nearer to 1"
            ) from None


class SimulatedMachineSettings(Settings):
    """Everything about the simulated machine that is not the vehicle's geometry."""

    kind: Literal["simulated"] = "simulated"
    """a kinematic chain; "physics": a multibody with tyres, see machine/physics/settings.py"""
    step: Annotated[float, Field(ge=1e-4, le=0.1)] = 0.01
    """integration step of the world; the sample period must be a multiple, s"""
    actuators: ActuatorSettings = ActuatorSettings()
    hydrostat: HydrostatSettings = HydrostatSettings()
    lengths: LengthFactors = LengthFactors()
    ground: GroundSettings = GroundSettings()
    sensors: SensorSettings = SensorSettings()
    low_level: LowLevelSettings = LowLevelSettings()
    terrain: TerrainSettings = TerrainSettings()
    bodies: BodySettings = BodySettings()
    masts: MastErrors = MastErrors()
    attitude: AttitudeSensors = AttitudeSensors()
    delays: DelaySettings = DelaySettings()
    events: Annotated[tuple[Event, ...], Field(strict=False)] = ()
    """what happens to the machine during a run, by kind"""

    @model_validator(mode="after")
    def _dead_time_on_grid(self) -> Self:
        demand_whole_steps("actuators.dead_time", self.actuators.dead_time, self.step)
        lags = {f"hydrostat.{name}": getattr(self.hydrostat, name) for name in ("speed_lag", "pedal_lag")}
        if self.low_level.kind == "valve":
            lags |= {"low_level.front.lag": self.low_level.front.lag, "low_level.joint.lag": self.low_level.joint.lag}
        for name, lag in lags.items():
            if not lag >= 0.5 * self.step:
                raise ValueError(
                    f"{name} = {lag} s is less than half of step = {self.step} s, which cannot follow it; raise it, or "
                    f"lower step"
                )
        if self.low_level.kind == "valve":
            demand_whole_steps("low_level.dead_time", self.low_level.dead_time, self.step)
        return self
