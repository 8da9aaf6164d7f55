"""The base of every configuration section, and the kinds of numbers a configuration may hold."""

import math
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator


class Settings(BaseModel):
    """A frozen section of a configuration: unknown keys, missing keys, NaN and infinity are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _only_known_keys(cls, data: Any) -> Any:
        """Refuse unknown keys before `extra` does, to say which ones there are."""
        unknown = [key for key in data if key not in cls.model_fields] if isinstance(data, dict) else []
        if unknown:
            raise ValueError(f"has no key {', '.join(unknown)}; its keys are: {', '.join(cls.model_fields)}")
        return data


def radians(value: float) -> float:
    """Return an angle; raise ValueError for one that must be in another unit."""
    if abs(value) > math.pi:
        raise ValueError(
            f"{value} is not an angle in radians within ±π; degrees? {value}° = {math.radians(value):.4f} rad"
        )
    return value


LONGEST, FASTEST = 30.0, 20.0
"""m of a vehicle's part, m/s: more than any tractor and trailer has"""


def metres(value: float) -> float:
    """Return a length; raise ValueError for one that must be in another unit."""
    if abs(value) > LONGEST:
        raise ValueError(
            f"{value} is not a length in metres up to {LONGEST:g} m; millimetres? {value:g} mm = {value / 1000:g} m"
        )
    return value


def metres_per_second(value: float) -> float:
    """Return a speed; raise ValueError for one that must be in another unit."""
    if abs(value) > FASTEST:
        raise ValueError(
            f"{value} is not a speed in m/s up to {FASTEST:g} m/s; km/h? {value:g} km/h = {value / 3.6:.3g} m/s"
        )
    return value


Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Length = Annotated[float, Field(gt=0.0), AfterValidator(metres)]
"""A length of a vehicle's part or a distance near it, m; one above 30 m is taken for millimetres and refused."""
NonNegativeLength = Annotated[float, Field(ge=0.0), AfterValidator(metres)]
Offset = Annotated[float, AfterValidator(metres)]
"""A length to either side, m."""
Speed = Annotated[float, Field(gt=0.0), AfterValidator(metres_per_second)]
"""A speed, m/s; one above 20 m/s is taken for km/h and refused."""
Angle = Annotated[float, AfterValidator(radians)]
"""An angle or angular rate in rad or rad/s; a magnitude above π is taken for degrees and refused."""
PositiveAngle = Annotated[float, Field(gt=0.0), AfterValidator(radians)]
NonNegativeAngle = Annotated[float, Field(ge=0.0), AfterValidator(radians)]
Horizon = Annotated[int, Field(ge=2, le=1000)]
"""Sampling intervals of a solver: from the fewest it can work with to more than one sample time can pay for."""
