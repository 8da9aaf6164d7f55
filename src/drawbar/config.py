"""Configuration: one TOML file describes a whole run; this is the only place that validates it."""

import os
import tomllib
from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

import tomli_w
from pydantic import Discriminator, Field, Tag, ValidationError, model_validator

from drawbar.bounded import BoundedErrors
from drawbar.config_tables import changed_table, resolved_table
from drawbar.control.plausibility import demand_samples_that_steer, demand_weights_that_steer
from drawbar.control.settings import (
    ArticulatedControllerSettings,
    ExternalControllerSettings,
    LqrSettings,
    PurePursuitSettings,
    TricycleControllerSettings,
    TubeSettings,
    is_module_and_class,
)
from drawbar.errors import ConfigurationError, demand, demand_path
from drawbar.estimation.actuation_settings import ActuationSettings
from drawbar.estimation.settings import ArticulatedEstimatorSettings, IdealEstimatorSettings, TricycleEstimatorSettings
from drawbar.guidance.settings import GuidanceSettings, PathSettings
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.safety.sanity import SanitySettings
from drawbar.safety.settings import SafetySettings
from drawbar.settings import Angle, Settings, Speed
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise
from drawbar.wrong_values import explained

SLOWEST = 0.05
"""lowest set speed, m/s"""
StartOffset = Annotated[float, Field(ge=-1000.0, le=1000.0)]
"""A distance from the start of the path, m; a run begins within guidance.maximum_start_distance of the path."""


class StartSettings(Settings):
    """Where the simulated machine stands at first, seen from the start of the path. The run begins beside it, anywhere.

    A recorded line, and a path with `path.working_width`, is driven in the direction in which the machine faces.
    """

    ahead: StartOffset = 0.0
    """m, along the path's first direction"""
    left: StartOffset = 0.0
    """m, across it"""
    yaw: Angle = 0.0
    """from the path's first direction, rad"""


class RecordingSettings(Settings):
    """What the log of a drive needs."""

    room: Annotated[float, Field(ge=3600.0, le=1e7)] = 36000.0
    """for how long the log should find room on the disk when `drawbar drive` begins, s: with less it says for how long
    there is, and with less than an hour's it does not begin"""


class TuningSettings(Settings):
    """What `drawbar tune` makes small, error and steering effort, and over which runs."""

    error: Literal["mean", "rms", "max"] = "mean"
    """statistic of the distance from the path over a run, m, mean of both bodies; the effort is the mean |steering
    rate|, rad/s, mean of both bodies"""
    seeds: Annotated[int, Field(ge=1, le=1000)] = 5
    """runs of a trial, with the seeds 0, 1, …"""
    fresh_seeds: Annotated[int, Field(ge=2, le=1000)] = 10
    """runs of everything that the search found, with the seeds that follow, which the search has not seen"""


def _kind(section: Any) -> str:
    """Return which machine a section describes: the simulated one where it names none."""
    kind = section.get("kind", "simulated") if isinstance(section, dict) else getattr(section, "kind", "simulated")
    return str(kind)


MachineSettings = Annotated[
    Annotated[SimulatedMachineSettings, Tag("simulated")] | Annotated[PhysicsMachineSettings, Tag("physics")],
    Discriminator(_kind),
]


class Configuration(Settings):
    """Everything that makes a run, and what to tune it for."""

    name: Annotated[str, Field(pattern=r"^[^/\\\x00-\x1f]+$")]
    """how reports and the folder of a run call it"""
    sample_time: Annotated[float, Field(gt=0.0, le=1.0)] = 0.2
    """s; RTK GNSS at 5 Hz"""
    speed: Annotated[Speed, Field(ge=SLOWEST)] = 1.0
    """set wheel speed, m/s"""
    acceleration: Annotated[float, Field(gt=0.0)] = 0.5
    """fastest change of the commanded speed during a run, m/s²; a run begins with the set speed"""
    vehicle: VehicleParameters = VehicleParameters()
    sensors: SensorNoise = SensorNoise()
    """what the estimator assumes of the sensors; the simulated ones are machine.sensors"""
    estimator: Annotated[
        ArticulatedEstimatorSettings | TricycleEstimatorSettings | IdealEstimatorSettings,
        Field(discriminator="model"),
    ]
    actuation: ActuationSettings = ActuationSettings()
    controller: Annotated[
        ArticulatedControllerSettings
        | TricycleControllerSettings
        | PurePursuitSettings
        | LqrSettings
        | ExternalControllerSettings,
        Field(discriminator="model"),
    ]
    tube: TubeSettings = TubeSettings()
    guidance: GuidanceSettings = GuidanceSettings()
    sanity: SanitySettings = SanitySettings()
    path: PathSettings = PathSettings()
    start: StartSettings = StartSettings()
    machine: MachineSettings = SimulatedMachineSettings()
    devices: DeviceSettings | None = None
    """of a real machine; none: `drawbar drive` uses stand-ins on this computer"""
    safety: SafetySettings = SafetySettings()
    """of a real machine's gate"""
    recording: RecordingSettings = RecordingSettings()
    bounded_errors: BoundedErrors = BoundedErrors()
    tuning: TuningSettings = TuningSettings()

    @property
    def has_trailer_receiver(self) -> bool:
        """Whether the trailer's position is measured."""
        return self.devices is None or self.devices.trailer_receiver is not None

    @model_validator(mode="before")
    @classmethod
    def _controller_of_ones_own(cls, data: Any) -> Any:
        """Take `controller.model = "module:Class"` for what it is short for."""
        section = data.get("controller") if isinstance(data, dict) else None
        if not isinstance(section, dict) or not is_module_and_class(model := str(section.get("model"))):
            return data
        return {**data, "controller": {**section, "model": "external", "implementation": model}}

    @model_validator(mode="after")
    def _within_reach_of_the_machine(self) -> Self:
        full_speed = self.machine.hydrostat.full_speed
        if not self.speed <= full_speed:
            raise ValueError(
                f"speed = {self.speed} m/s is above machine.hydrostat.full_speed = {full_speed} m/s; lower it, "
                "or raise the other where the machine is faster"
            )
        for body in ("tractor", "trailer"):
            limit = getattr(self.vehicle, f"{body}_steering_limit")
            stop = getattr(self.machine.actuators, f"{body}_stop")
            if not limit <= stop:
                raise ValueError(
                    f"vehicle.{body}_steering_limit = {limit} rad is beyond the machine's mechanical stop, "
                    f"machine.actuators.{body}_stop = {stop} rad; lower it, "
                    "or raise the other where the machine turns further"
                )
        return self

    @model_validator(mode="after")
    def _samples_and_weights_that_steer(self) -> Self:
        if isinstance(self.controller, ArticulatedControllerSettings | TricycleControllerSettings):
            pace = {"wheelbase": self.vehicle.wheelbase, "speed": self.speed, "sample_time": self.sample_time}
            demand_samples_that_steer(**pace)
            demand_weights_that_steer(self.controller, **pace)
        return self

    @model_validator(mode="after")
    def _guidance_of_tracked_points(self) -> Self:
        if not (self.vehicle.tracked.are_the_bodies or self.guidance.mode == "preview"):
            raise ValueError('vehicle.tracked needs guidance.mode = "preview"; choose it, or leave vehicle.tracked out')
        return self

    @model_validator(mode="after")
    def _begin_nearer_than_lost(self) -> Self:
        begin, lost = self.guidance.maximum_start_distance, self.sanity.lost
        if not begin < lost:
            raise ValueError(
                f"guidance.maximum_start_distance = {begin} m must be less than sanity.lost = {lost} m, beyond which a "
                f"run ends; lower the one or raise the other"
            )
        return self

    @model_validator(mode="after")
    def _errors_of_what_is_there(self) -> Self:
        if self.machine.kind == "physics" and any(bound for _, bound in self.bounded_errors.ground):
            raise ValueError(
                'bounded_errors.ground needs machine.kind = "simulated", in the physics the ground acts through '
                "forces; leave these bounds zero"
            )
        if self.estimator.model != "ideal" and any(bound for _, bound in self.bounded_errors.estimate):
            raise ValueError(
                f'bounded_errors.estimate needs estimator.model = "ideal", which is "{self.estimator.model}"; '
                f'set it to "ideal", or leave these bounds zero'
            )
        return self

    def to_toml(self) -> str:
        """Return the complete configuration, defaults included, as TOML."""
        return tomli_w.dumps(self.model_dump(mode="json", exclude_none=True))


def load_configuration(source: str | os.PathLike[str], changes: Sequence[str] = ()) -> Configuration:
    """Read a configuration file, or a shipped one by name, with changes applied.

    A file may start with `extends = "articulated"` (a shipped name, or a file beside it) and give only what differs;
    an empty section, `tube = {}`, takes back all of it in the other. A relative `path.file` is beside the file
    that names it, one of the changes in the working directory; the configuration returned holds it as absolute.

    Args:
        source: path of a TOML file, or a shipped name.
        changes: texts `key.key=value`, the value in TOML (a bare word is taken as a string).

    Raises:
        ConfigurationError: unreadable, not TOML, duplicate, unknown, missing or impossible key; names which and why.
    """
    name = source if isinstance(source, str) else str(demand_path("source", source, ConfigurationError))
    _demand_changes(changes)
    data, origin = resolved_table(name)
    return _changed(_validated(data, origin), changes, origin)


def recorded_configuration(text: str, changes: Sequence[str], origin: str) -> Configuration:
    """Return the configuration that a log holds (complete TOML), with some values changed.

    Args:
        text: TOML.
        changes: KEY=VALUE, as in load_configuration.
        origin: what error messages call it.

    Raises:
        ConfigurationError: this version of drawbar cannot read it, or a change is wrong; names which and why.
    """
    _demand_changes(changes)
    return _changed(_validated(tomllib.loads(text), origin), changes, origin)


def _demand_changes(changes: object) -> None:
    if (
        isinstance(changes, str)
        or not isinstance(changes, Sequence)
        or not all(isinstance(change, str) for change in changes)
    ):
        raise ConfigurationError(f"changes must be texts KEY=VALUE, got {changes!r}; give ['speed=1.5'], for example.")


def demand_configuration(configuration: object) -> None:
    """Raise ConfigurationError where an argument is no configuration, such as the name of one."""
    advice = 'give what load_configuration returns, such as load_configuration("articulated")'
    demand("configuration", configuration, Configuration, advice, ConfigurationError)


def _changed(configuration: Configuration, changes: Sequence[str], origin: str) -> Configuration:
    if not changes:
        return configuration
    return _validated(
        changed_table(configuration.model_dump(mode="json"), changes), f"{origin} with --set {' '.join(changes)}"
    )


def _validated(data: dict[str, Any], origin: str) -> Configuration:
    try:
        return Configuration.model_validate(data)
    except ValidationError as error:
        message = explained(error, data, origin)
        if not {"estimator", "controller"} <= data.keys():  # a first file: hardly meant to be complete
            message += '\n  Begin the file with extends = "articulated": then only what differs has to be given.'
        raise ConfigurationError(message) from error
