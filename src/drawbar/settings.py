"""Settings: the base of every configuration section, and the kinds of numbers a configuration may hold."""

import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, field_validator, model_validator

from drawbar.misspelt import meant

SMALLEST, LARGEST = 1e-12, 1e9
"""Magnitudes of a number that is not zero: squares and inverse squares are finite in single precision too, and whole
numbers are those of C."""


class Settings(BaseModel):
    """A frozen section of a configuration: unknown keys, missing keys, NaN, infinity, absurd numbers are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)
    former_keys: ClassVar[Mapping[str, str]] = {}
    """what keys are called now that older logs and configurations hold by another name"""

    @model_validator(mode="before")
    @classmethod
    def _only_known_keys(cls, data: Any) -> Any:
        """Rename former keys, in the data themselves; before `extra` does, refuse unknown ones and name the known."""
        if not isinstance(data, dict):
            return data
        for former, present in cls.former_keys.items():
            if former in data:
                data[present] = data.pop(former)
        unknown = [key for key in data if key not in cls.model_fields]
        if unknown:
            named = ", ".join(f"{key}{meant(key, cls.model_fields)}" for key in unknown)
            raise ValueError(f"has no key {named}; its keys are: {', '.join(cls.model_fields)}")
        return data

    @field_validator("*")
    @classmethod
    def _of_sane_magnitude(cls, value: Any) -> Any:
        """Refuse numbers with which nobody can compute, those of lists and tables included."""
        for place, number in _numbers(value):
            if number and not SMALLEST <= abs(number) <= LARGEST:
                raise ValueError(f"{place}a number must be 0, or from {SMALLEST:g} to {LARGEST:g} with either sign")
        return value


def _numbers(value: Any) -> Iterator[tuple[str, float]]:
    """Yield the number that a value is, or all that it holds, each with its name in a table and a colon.

    Sections within the value have looked at their own numbers.
    """
    if isinstance(value, int | float):
        yield "", value
    elif isinstance(value, Mapping):
        yield from ((f"{name} = {each}: ", each) for name, each in value.items() if isinstance(each, int | float))
    elif isinstance(value, tuple):
        yield from (found for each in value for found in _numbers(each))


def radians(value: float) -> float:
    """Return an angle; raise ValueError for one that must be in another unit."""
    if abs(value) > math.pi:
        raise ValueError(
            f"{value} is not an angle in radians within ±π; degrees? {value}° = {math.radians(value):.4f} rad"
        )
    return value


LONGEST, HIGHEST, FASTEST, LATEST = 30.0, 6.0, 20.0, 1.0
"""m of a vehicle's part, m of an antenna above the ground, m/s, s of a device's delay: more than any tractor and
trailer has"""


def metres(value: float) -> float:
    """Return a length; raise ValueError for one that must be in another unit."""
    if abs(value) > LONGEST:
        raise ValueError(
            f"{value} is not a length in metres up to {LONGEST:g} m; "
            f"{value:g} cm = {value / 100:g} m, {value:g} mm = {value / 1000:g} m"
        )
    return value


def mast_height(value: float) -> float:
    """Return the height of an antenna, m; raise ValueError for one that must be in another unit."""
    if metres(value) > HIGHEST:
        raise ValueError(
            f"{value} m is higher than an antenna stands, {HIGHEST:g} m; feet? {value:g} ft = {0.3048 * value:.2f} m"
        )
    return value


def metres_per_second(value: float) -> float:
    """Return a speed; raise ValueError for one that must be in another unit."""
    if abs(value) > FASTEST:
        raise ValueError(
            f"{value} is not a speed in m/s up to {FASTEST:g} m/s; km/h? {value:g} km/h = {value / 3.6:.3g} m/s"
        )
    return value


def seconds(value: float) -> float:
    """Return a delay; raise ValueError for one that must be in another unit."""
    if value > LATEST:
        raise ValueError(f"{value} is not a delay in seconds up to {LATEST:g} s; ms? {value:g} ms = {value / 1000:g} s")
    return value


Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
DeadTime = Annotated[float, Field(ge=0.0, le=5.0)]
"""Of a simulated actuator, s: commands are kept for so long."""
Delay = Annotated[float, Field(ge=0.0), AfterValidator(seconds)]
"""Of a real device, s; one above 1 s is taken for ms and refused."""
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Length = Annotated[float, Field(gt=0.0), AfterValidator(metres)]
"""A length of a vehicle's part or a distance near it, m; one above 30 m is taken for another unit and refused."""
NonNegativeLength = Annotated[float, Field(ge=0.0), AfterValidator(metres)]
MastHeight = Annotated[float, Field(ge=0.0), AfterValidator(mast_height)]
"""Of an antenna above the ground, m; one above 6 m is taken for feet and refused."""
Offset = Annotated[float, AfterValidator(metres)]
"""A length to either side, m."""
Speed = Annotated[float, Field(gt=0.0), AfterValidator(metres_per_second)]
"""A speed, m/s; one above 20 m/s is taken for km/h and refused."""
Angle = Annotated[float, AfterValidator(radians)]
"""An angle or angular rate in rad or rad/s; a magnitude above π is taken for degrees and refused."""
PositiveAngle = Annotated[float, Field(gt=0.0), AfterValidator(radians)]
NonNegativeAngle = Annotated[float, Field(ge=0.0), AfterValidator(radians)]
Horizon = Annotated[int, Field(ge=2, le=200)]
"""Sampling intervals of a solver: from the fewest it can work with to more than one sample time can pay for."""
