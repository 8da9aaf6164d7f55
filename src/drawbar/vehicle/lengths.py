"""The vehicle's lengths as constants of its models: numbers that a solver takes as data."""

from dataclasses import dataclass, fields
from typing import Any

from drawbar.vehicle.model import Constant, constant
from drawbar.vehicle.parameters import VehicleParameters


@dataclass(frozen=True, slots=True, kw_only=True)
class Lengths:
    """The vehicle's lengths in the equations of motion, SX symbols or numbers, m; see VehicleParameters."""

    wheelbase: Any
    hitch_length: Any
    free_joint_offset: Any
    drawbar_length: Any
    trailer_length: Any
    trailer_antenna: Any


def length_values(vehicle: VehicleParameters) -> Lengths:
    """Return the lengths as numbers, m."""
    return Lengths(**{each.name: getattr(vehicle, each.name) for each in fields(Lengths)})


def lengths_of(vehicle: VehicleParameters) -> tuple[Lengths, tuple[Constant, ...]]:
    """Return the lengths as symbols, and the constants with their values."""
    constants = {each.name: constant(each.name, "m", getattr(vehicle, each.name)) for each in fields(Lengths)}
    return Lengths(**{name: each.symbol for name, each in constants.items()}), tuple(constants.values())
