"""Matching settings: what vehicle, controller, devices and gate take for possible must fit before a drive.

Each setting is allowed by itself, and a simulated run knows no gate; so this is checked where a machine is driven.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from drawbar.config import Configuration
from drawbar.errors import ConfigurationError
from drawbar.safety.following import NEAR

_ENGAGING = {"lateral_deviation": "m", "lateral_error": "m", "hitch_angle": "rad", "correction_age": "s"}
"""limits of engaging that are limits of driving, too, and their units"""
_AXLES = 0.1
"""share by which the distance of the axles by which a valve is commanded may differ from the vehicle's"""


@dataclass(frozen=True, slots=True)
class _Pair:
    """Two settings, by name, of which the first must not be above the second, or not as large."""

    lower: str
    upper: str
    unit: str
    why: str
    equal: bool = True
    """they may be equal"""

    def flaw(self, configuration: Configuration) -> str | None:
        """Return what is wrong with them, and what to do; None where they match."""
        lower, upper = _value(configuration, self.lower), _value(configuration, self.upper)
        if lower < upper or (self.equal and lower == upper):
            return None
        return (
            f"{self.lower} = {_shown(lower, self.unit)} is {'above' if self.equal else 'not below'} {self.upper} = "
            f"{_shown(upper, self.unit)}: {self.why}; lower the one or raise the other"
        )


def demand_matching_settings(configuration: Configuration) -> None:
    """Refuse settings of vehicle and controller that contradict those of gate or devices.

    Raises:
        ConfigurationError: says which, what each is, why they do not fit, and what to do.
    """
    flaws = [flaw for pair in _pairs() if (flaw := pair.flaw(configuration)) is not None]
    flaws += [flaw for body in ("tractor", "trailer") for flaw in _beyond_reach(configuration, body)]
    flaws += _other_wheelbase(configuration)
    if flaws:
        raise ConfigurationError("\n".join(flaws))


def _pairs() -> Iterator[_Pair]:
    yield _Pair("speed", "safety.envelope.speed", "m/s", "the gate stops a vehicle that is faster")
    for body in ("tractor", "trailer"):
        rate, slips = f"vehicle.{body}_steering_rate", "a steering that turns so fast is taken for a sensor that slips"
        yield _Pair(rate, "safety.envelope.steering_rate", "rad/s", "the gate limits commands that are planned so fast")
        yield _Pair(rate, "safety.drive.jump_rate", "rad/s", slips)
    stuck = "a steering that reacts so late is taken for stuck"
    yield _Pair("vehicle.dead_time", "safety.drive.stuck_time", "s", stuck, equal=False)
    silent = "between two samples the controller is taken for silent"
    yield _Pair("sample_time", "safety.timing.controller", "s", silent, equal=False)
    for name, unit in _ENGAGING.items():
        yield _Pair(f"safety.engage.{name}", f"safety.drive.{name}", unit, "what has just been engaged is stopped")


def _beyond_reach(configuration: Configuration, body: str) -> Iterator[str]:
    """Yield what is wrong where a body may be steered beyond what its board or valve reaches.

    A board clamps its set points, and what stays far from them seems stuck; a valve ends steering beyond its table.
    """
    devices, limit = configuration.devices, f"vehicle.{body}_steering_limit"
    if devices is None:
        return
    board, wanted = getattr(devices, f"{body}_board"), _value(configuration, limit)
    table = None if board is not None else getattr(devices.isobus, f"{body}_valve").curvature
    if board is not None:
        name, reached, allowed = (
            f"{body}_board.max_angle",
            board.max_angle,
            configuration.safety.drive.stuck_angle * NEAR,
        )
        why = f"a steering that stays more than {_shown(allowed, 'rad')} away from where it is to go is taken for stuck"
    elif table is not None:
        name, reached, allowed = f"isobus.{body}_valve.curvature", min(-table[0][0], table[-1][0]), 0.0
        why = "beyond its table nothing is commanded, and steering ends"
    else:
        return
    if wanted - reached > allowed:
        yield (
            f"{limit} = {_shown(wanted, 'rad')} is beyond devices.{name}, which reaches {_shown(reached, 'rad')}: {why}"
            "; lower the one or raise the other"
        )


def _other_wheelbase(configuration: Configuration) -> Iterator[str]:
    """Yield what is wrong where a valve is commanded as that of a vehicle with another distance of the axles."""
    devices, own = configuration.devices, configuration.vehicle.wheelbase
    valve = devices.isobus.tractor_valve if devices is not None and devices.isobus is not None else None
    if valve is not None and valve.wheelbase is not None and abs(valve.wheelbase - own) > _AXLES * own:
        yield (
            f"devices.isobus.tractor_valve.wheelbase = {valve.wheelbase:.4g} m is not vehicle.wheelbase = {own:.4g} m: "
            "the wheels would turn by other angles than are commanded; give both the distance of the axles"
        )


def _value(configuration: Configuration, name: str) -> float:
    value: object = configuration
    for key in name.split("."):
        value = getattr(value, key)
    assert isinstance(value, float)
    return value


def _shown(value: float, unit: str) -> str:
    """Return a setting's value with its unit, an angle also in degrees."""
    degrees = f" ({math.degrees(value):.3g}{unit.replace('rad', '°')})" if unit.startswith("rad") else ""
    return f"{value:.4g} {unit}{degrees}"
