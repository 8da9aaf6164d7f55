"""CAN machine: devices of a stand-in machine on its ISOBUS; valves of the bodies, a tractor that takes a speed."""

from drawbar.machine.hardware.isobus import IsobusSettings
from drawbar.machine.stand_in.can_devices import CanDevices
from drawbar.machine.stand_in.tractor_ecu import StandInTractor
from drawbar.machine.stand_in.valve import StandInValve
from drawbar.protocols.isobus.address import AddressClaim
from drawbar.protocols.isobus.curvature import CurvatureMap
from drawbar.protocols.isobus.name import Name
from drawbar.protocols.isobus.node import IsobusNode
from drawbar.transports.base import CanBus, CanFrame

_ADDRESSES = {"tractor": 0xA0, "trailer": 0xA1}
"""of valves whose address the settings do not name"""
_TRACTOR = 0xA2


class _CutBus(CanBus):
    """A bus without any other node."""

    connected = False

    def fileno(self) -> int:
        return -1

    def read(self) -> list[tuple[float, CanFrame]]:
        return []

    def write(self, frame: CanFrame) -> bool:
        return False

    def close(self) -> None:
        pass


class CanMachine:
    """The devices on one end of a bus; `step` them with the machine."""

    def __init__(self, bus: CanBus, settings: IsobusSettings, *, takes_speed: bool) -> None:
        """Put there what the settings name; takes_speed: the tractor obeys speed commands."""
        self.valves: dict[str, StandInValve] = {}
        self._maps: dict[str, CurvatureMap] = {}
        self._nodes: list[IsobusNode] = []
        for body, valve in (("tractor", settings.tractor_valve), ("trailer", settings.trailer_valve)):
            if valve is not None:
                address = _ADDRESSES[body] if valve.address is None else valve.address
                self.valves[body] = StandInValve(self._node(address), rate=None)
                self._maps[body] = valve.map()
        self.tractor = StandInTractor(self._node(_TRACTOR))
        self._takes_speed = takes_speed
        self._devices = CanDevices(bus, self._nodes)

    def set_points(self) -> dict[str, float | None]:
        """Return the angles to which valves turn, rad, by body; None: it releases."""
        targets = {body: valve.target for body, valve in self.valves.items()}
        return {body: None if each is None else self._maps[body].angle(each) for body, each in targets.items()}

    def speed(self, time: float) -> float | None:
        """Return the speed that is asked of the tractor at a time (s), m/s; None: the driver drives."""
        return self.tractor.commanded(time) if self._takes_speed else None

    def step(self, time: float, angles: dict[str, float], speed: float) -> None:
        """Let the devices measure steering angles (rad, by body) and the wheels' speed (m/s), receive and send."""
        for body, valve in self.valves.items():
            valve.curvature, valve.speed = self._maps[body].curvature(angles[body]), speed
        self.tractor.wheel_speed = self.tractor.ground_speed = speed
        self._devices.step(time)

    def cut(self) -> None:
        """Take all devices off the bus: they continue by themselves, and neither receive nor send any more."""
        self._devices = CanDevices(_CutBus(), self._nodes)

    def _node(self, address: int) -> IsobusNode:
        name = Name(identity=len(self._nodes) + 1, manufacturer=0, function=0, device_class=1)
        self._nodes.append(IsobusNode(AddressClaim(name, address)))
        return self._nodes[-1]
