"""One TOML file describes a whole run; this is the only place that reads it."""

import tomllib
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Annotated, Any

import tomli_w
from pydantic import Field, ValidationError

from drawbar.control.settings import ArticulatedControllerSettings, TricycleControllerSettings, TubeSettings
from drawbar.errors import ConfigurationError
from drawbar.estimation.settings import ArticulatedEstimatorSettings, TricycleEstimatorSettings
from drawbar.guidance.settings import GuidanceSettings
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.settings import Angle, Positive, Settings
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise


class PathSettings(Settings):
    """What to drive: a recorded line, or else figure-eights."""

    file: str = ""
    """AgOpenGPS field folder, CSV or GeoJSON file; empty: the figure-eights"""
    track: str = ""
    """name of the line, where the file holds several"""
    radii: Annotated[tuple[Positive, ...], Field(strict=False, min_length=1)] = (10.0, 8.0, 6.67)
    """of the figure-eights, one after the other, m"""
    straight_length: Positive = 20.0
    """of the figure-eights' straights, m"""


class StartSettings(Settings):
    """Where the simulated machine stands at first, seen from the start of the path."""

    ahead: float = 0.0
    """m, along the path's first direction"""
    left: float = 0.0
    """m, across it"""
    yaw: Angle = 0.0
    """from the path's first direction, rad"""


class Configuration(Settings):
    """Everything that makes a run."""

    name: str
    """how reports call it"""
    sample_time: Positive = 0.2
    """s; RTK GNSS at 5 Hz"""
    speed: Positive = 1.0
    """set wheel speed, m/s"""
    vehicle: VehicleParameters = VehicleParameters()
    sensors: SensorNoise = SensorNoise()
    """what the estimator believes of the sensors; the simulated ones are machine.sensors"""
    estimator: Annotated[ArticulatedEstimatorSettings | TricycleEstimatorSettings, Field(discriminator="model")]
    controller: Annotated[ArticulatedControllerSettings | TricycleControllerSettings, Field(discriminator="model")]
    tube: TubeSettings
    guidance: GuidanceSettings = GuidanceSettings()
    path: PathSettings = PathSettings()
    start: StartSettings = StartSettings()
    machine: SimulatedMachineSettings = SimulatedMachineSettings()

    def to_toml(self) -> str:
        """Return the complete configuration, defaults included, as TOML."""
        return tomli_w.dumps(self.model_dump(mode="json"))


def shipped_names() -> list[str]:
    """Return the names of the configurations that come with drawbar."""
    return sorted(file.name.removesuffix(".toml") for file in _shipped().iterdir() if file.name.endswith(".toml"))


def load_configuration(source: str, changes: Sequence[str] = ()) -> Configuration:
    """Read a configuration file, or a shipped one by name, with changes applied.

    Args:
        source: path of a TOML file, or a shipped name.
        changes: texts `key.key=value`, the value in TOML (a bare word is taken as a string).

    Raises:
        ConfigurationError: unreadable, not TOML, duplicate, unknown, missing or impossible key; says which and why.
    """
    text, origin = _read(source)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigurationError(f"{origin}: is not valid TOML: {error}.") from error
    configuration = _validated(data, origin)
    if not changes:
        return configuration
    resolved = configuration.model_dump(mode="json")
    for change in changes:
        _apply(resolved, change)
    return _validated(resolved, f"{origin} with --set {' '.join(changes)}")


def _shipped() -> Any:
    return resources.files("drawbar") / "configurations"


def _read(source: str) -> tuple[str, str]:
    if source in shipped_names():
        return (_shipped() / f"{source}.toml").read_text("utf-8"), source
    try:
        return Path(source).read_text("utf-8"), source
    except (OSError, UnicodeDecodeError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise ConfigurationError(
            f"{source}: cannot be read as a configuration ({reason}); give a TOML file or one of: {', '.join(shipped_names())}."
        ) from error


def _validated(data: dict[str, Any], origin: str) -> Configuration:
    try:
        return Configuration.model_validate(data)
    except ValidationError as error:
        lines = [_explain(problem) for problem in error.errors()]
        raise ConfigurationError("\n".join([f"{origin}: {len(lines)} wrong value(s).", *lines])) from error


def _explain(problem: Any) -> str:
    """Return one line: key, what was given, what is allowed."""
    key = ".".join(str(part) for part in problem["loc"] if part not in ("articulated", "tricycle"))
    given = problem["input"]
    reason = problem["msg"].removeprefix("Value error, ")
    if problem["type"] == "extra_forbidden":
        return f"  {key}: there is no such key; look at the shipped configurations for those there are."
    if problem["type"] == "missing":
        return f"  {key}: is missing; add it."
    shown = given if isinstance(given, int | float | str | bool) else f"a {type(given).__name__}"
    return (
        f"  {key} = {shown!r}: {reason[0].lower()}{reason[1:]}."
        if shown is not given or given != ""
        else f"  {key}: {reason}."
    )


def _apply(data: dict[str, Any], change: str) -> None:
    """Set one dotted key in place."""
    key, separator, text = change.partition("=")
    if not separator or not key.strip():
        raise ConfigurationError(f"--set {change!r}: give KEY=VALUE, for example --set vehicle.wheelbase=1.5.")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text
    *sections, last = key.strip().split(".")
    for section in sections:
        data = data.setdefault(section, {}) if isinstance(data, dict) else data
    if not isinstance(data, dict):
        raise ConfigurationError(f"--set {change!r}: {'.'.join(sections)} is a value, not a section with keys.")
    data[last] = value
