"""Set-up values: keys of the configuration that can be set by hand, in the units that people use."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce

from drawbar.config import Configuration


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """A unit that people use."""

    name: str
    decimals: int
    to_si: Callable[[float], float]
    from_si: Callable[[float], float]


def _scaled(name: str, decimals: int, factor: float) -> Unit:
    return Unit(name=name, decimals=decimals, to_si=lambda value: value / factor, from_si=lambda value: value * factor)


def _inverse(value: float) -> float:
    return 1.0 / value if value else math.inf


CENTIMETRES, SECONDS = _scaled("cm", 1, 100.0), _scaled("s", 2, 1.0)
DEGREES, DEGREES_PER_SECOND = _scaled("°", 1, 180.0 / math.pi), _scaled("°/s", 1, 180.0 / math.pi)
KMH = _scaled("km/h", 1, 3.6)
RADIUS = Unit(name="m", decimals=2, to_si=_inverse, from_si=_inverse)
"""of what is a curvature in the configuration"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SetUpValue:
    """One number."""

    key: str
    """in the configuration"""
    text: str
    """key of its name in the catalogue"""
    unit: Unit
    letter: str = ""
    """by which the drawing calls it; empty: it is not drawn"""

    def shown(self, configuration: Configuration) -> float:
        """Return the configuration's value in this unit, rounded as it is shown."""
        return round(self.unit.from_si(self.found(configuration)), self.unit.decimals)

    def found(self, configuration: Configuration) -> float:
        """Return the configuration's value."""
        return float(reduce(getattr, self.key.split("."), configuration))  # type: ignore[arg-type]

    def change(self, value: float) -> str:
        """Return KEY=VALUE for a value in this unit."""
        return f"{self.key}={float(f'{self.unit.to_si(value):.12g}')!r}"


def _length(key: str, text: str, letter: str) -> SetUpValue:
    return SetUpValue(key=f"vehicle.{key}", text=text, unit=CENTIMETRES, letter=letter)


LENGTHS = (
    _length("wheelbase", "wheelbase", "A"),
    _length("hitch_length", "hitch_length", "B"),
    _length("drawbar_length", "drawbar_length", "C"),
    _length("trailer_length", "trailer_length", "D"),
    _length("trailer_antenna", "tracked_point", "E"),
)
MASTS = (
    _length("masts.tractor.forward", "tractor_mast_forward", "F"),
    _length("masts.tractor.left", "tractor_mast_left", "G"),
    _length("masts.tractor.up", "tractor_mast_up", "H"),
    _length("masts.trailer.forward", "trailer_mast_forward", "J"),
    _length("masts.trailer.left", "trailer_mast_left", "K"),
    _length("masts.trailer.up", "trailer_mast_up", "L"),
)
LIMITS = (
    SetUpValue(key="speed", text="driving_speed", unit=KMH),
    SetUpValue(key="vehicle.curvature_limit", text="smallest_radius", unit=RADIUS),
    SetUpValue(key="vehicle.tractor_steering_limit", text="wheels_limit", unit=DEGREES),
    SetUpValue(key="vehicle.trailer_steering_limit", text="joint_limit", unit=DEGREES),
    SetUpValue(key="vehicle.tractor_steering_rate", text="wheels_rate", unit=DEGREES_PER_SECOND),
    SetUpValue(key="vehicle.trailer_steering_rate", text="joint_rate", unit=DEGREES_PER_SECOND),
    SetUpValue(key="vehicle.steering_lag", text="steering_lag", unit=SECONDS),
    SetUpValue(key="vehicle.dead_time", text="dead_time", unit=SECONDS),
    SetUpValue(key="guidance.path_tolerance", text="smoothing_limit", unit=CENTIMETRES),
)
GROUPS = (("lengths", LENGTHS), ("masts", MASTS), ("limits", LIMITS))
"""catalogue's key of the title, and its values"""
