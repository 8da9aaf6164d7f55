"""ISOBUS settings: the bus, drawbar's own NAME and address on it, and the valves that it steers."""

from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from drawbar.errors import ConfigurationError
from drawbar.protocols.isobus.address import AddressClaim
from drawbar.protocols.isobus.curvature import CurvatureMap, TableCurvature, WheelbaseCurvature
from drawbar.protocols.isobus.guidance import GuidanceValve
from drawbar.protocols.isobus.heartbeat import Heartbeat
from drawbar.protocols.isobus.name import Name
from drawbar.protocols.isobus.node import IsobusNode
from drawbar.settings import Angle, Length, Settings
from drawbar.transports.address import BusText

Address = Annotated[int, Field(ge=0, le=253)]
"""An address on the bus; 254 means none, 255 means all."""

_CURVIEST = 8.0
"""1/m: more does not go into the message"""


def _per_metre(value: float) -> float:
    """Return a curvature; raise ValueError for one that must be in another unit."""
    if abs(value) > _CURVIEST:
        raise ValueError(
            f"{value} is not a curvature in 1/m within ±{_CURVIEST:g}, as valves take; 1/km? {value:g} 1/km = "
            f"{value / 1000.0:g} 1/m"
        )
    return value


Pair = Annotated[tuple[Angle, Annotated[float, AfterValidator(_per_metre)]], Field(strict=False)]
"""A calibrated pair: angle, rad, and curvature, 1/m, left positive."""


class NameSettings(Settings):
    """Drawbar's NAME: who it is on the bus. Codes are assigned by the ISOBUS registry (isobus.net)."""

    identity: Annotated[int, Field(ge=0, lt=1 << 21)]
    """serial number; no two devices of one manufacturer on a bus may share it"""
    manufacturer: Annotated[int, Field(ge=0, lt=1 << 11)] = 1407
    """code of the manufacturer; 1407 is said to be that of open-source projects: look it up"""
    function: Annotated[int, Field(ge=0, lt=1 << 8)] = 29
    """code of a guidance controller: look it up"""
    device_class: Annotated[int, Field(ge=0, lt=1 << 7)] = 1
    """1: tractor"""
    function_instance: Annotated[int, Field(ge=0, lt=1 << 5)] = 0
    """which of several guidance controllers on the bus"""
    ecu_instance: Annotated[int, Field(ge=0, lt=1 << 3)] = 0
    """which of several control units of that function"""
    self_configurable: bool = True
    """may move to an address of 128 to 247 where its own is taken; False: is silent then"""

    def name(self) -> Name:
        """Return the NAME."""
        return Name(**self.model_dump())


class ValveSettings(Settings):
    """One steering valve: what its curvature means, and where it is."""

    wheelbase: Length | None = None
    """of a front-steered tractor, m: curvature = tan(angle) / wheelbase"""
    curvature: Annotated[tuple[Pair, ...], Field(strict=False)] | None = None
    """of a trailer's axle or joint: calibrated pairs of angle, rad, and curvature, 1/m, left positive, both rising"""
    address: Address | None = None
    """of the valve; only where it is the only one on the bus it may be left out"""
    rate: Annotated[float, Field(ge=10.0, le=20.0)] = 10.0
    """commands each second, Hz; more than 10 only where the valve's maker agrees"""

    @model_validator(mode="after")
    def _one_curvature(self) -> Self:
        if (self.wheelbase is None) == (self.curvature is None):
            raise ValueError("needs either wheelbase (front wheels) or curvature (a trailer's axle or joint), not both")
        try:
            self.map()
        except ConfigurationError as error:
            raise ValueError(str(error)) from error
        return self

    def map(self) -> CurvatureMap:
        """Return what turns angles into curvatures."""
        if self.wheelbase is not None:
            return WheelbaseCurvature(self.wheelbase)
        return TableCurvature(self.curvature or ())


class IsobusSettings(Settings):
    """One ISOBUS: where it is plugged in, who drawbar is on it, and what it steers there."""

    bus: BusText
    """`can:INTERFACE:CHANNEL` of python-can, as `can:socketcan:can0`"""
    name: NameSettings
    preferred_address: Address = 128
    """claimed first; 128 to 247 are for devices that may move"""
    tractor_valve: ValveSettings | None = None
    """of the front wheels"""
    trailer_valve: ValveSettings | None = None
    """of the trailer's axle or joint"""

    @model_validator(mode="after")
    def _each_has_an_address_of_its_own(self) -> Self:
        both = (self.tractor_valve, self.trailer_valve)
        addresses = [valve.address for valve in both if valve is not None]
        if len(addresses) == 2 and (None in addresses or addresses[0] == addresses[1]):
            raise ValueError(f"two valves on one bus need an address each, and different ones; given are {addresses}")
        if self.preferred_address in addresses:
            raise ValueError(f"preferred_address = {self.preferred_address} is a valve's; drawbar needs another one")
        return self

    def node(self) -> IsobusNode:
        """Return drawbar's own node, its heartbeat included."""
        node = IsobusNode(AddressClaim(self.name.name(), self.preferred_address))
        Heartbeat(node)
        return node


def guidance_valve(node: IsobusNode, settings: ValveSettings) -> GuidanceValve:
    """Return the actuator of one valve under a node."""
    return GuidanceValve(node, settings.map(), address=settings.address, period=1.0 / settings.rate)
