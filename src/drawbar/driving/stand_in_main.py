"""The stand-in as a program: the simulated machine behind real sockets, in real time or faster.

`python -m drawbar.driving.stand_in_main`, its orders on standard input. It serves what the configuration's `devices`
name: a receiver at `tcp://` listens there, one at `udp://` is sent to; a board answers at its address, and so does a
caster whose address is this computer's.
"""

import math
import socket
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from urllib.parse import urlsplit

from drawbar.config import Configuration, load_configuration
from drawbar.driving.ending import Ending, told
from drawbar.driving.mail import Mailbox
from drawbar.driving.orders import DRIVER, Orders
from drawbar.driving.pace import lamp_of
from drawbar.driving.place import local_frame
from drawbar.driving.stand_in_caster import stand_in_caster
from drawbar.driving.stand_ins import SEED, Firmware, stand_in_machine
from drawbar.errors import HardwareError
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.receiver import CAN
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.machine.stand_in.board import Output
from drawbar.machine.stand_in.caster import Caster
from drawbar.machine.stand_in.faults import FaultPlan, PlannedFault
from drawbar.machine.stand_in.machine import BARE_VALVE, BODIES, SENSORS, Driver, StandInMachine
from drawbar.message_records import decode
from drawbar.messages import GateState, SupervisorState
from drawbar.protocols.agopengps.steer_board import SET_POINT
from drawbar.protocols.rtcm import RtcmFramer
from drawbar.realtime import schedule_first
from drawbar.safety.causes import Cause
from drawbar.simulation import build_path
from drawbar.transports.address import is_loopback
from drawbar.transports.can_listener import unpacked
from drawbar.transports.open import open_can

_PRIORITY = 30
"""of its scheduling, below gate and controller: real devices do not wait for this computer's other programs"""
_GONE = 1.0
"""without a word of who commands the steerings, s"""


class DataLine:
    """Where the bytes of a receiver or a sensor board go: everybody who is connected to its TCP port, or a UDP port."""

    def __init__(self, address: str) -> None:
        """Open it.

        Raises:
            HardwareError: the port is taken, or a stand-in cannot be at such an address.
        """
        parts = urlsplit(address)
        if parts.scheme not in ("tcp", "udp") or parts.port is None:
            raise HardwareError(f"a stand-in cannot be at {address}; give tcp://HOST:PORT or udp://HOST:PORT")
        self._place = (parts.hostname or "127.0.0.1", parts.port)
        self._peers: list[socket.socket] = []
        self._listens = parts.scheme == "tcp"
        if self._listens:
            self._socket = _bound(socket.SOCK_STREAM, self._place, address)
            self._socket.listen()
        else:
            self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self._socket.setblocking(False)

    def send(self, data: bytes) -> None:
        """Send to whoever is there."""
        if not self._listens:
            self._socket.sendto(data, self._place)
            return
        with suppress(BlockingIOError):  # nobody new has connected
            self._peers.append(self._socket.accept()[0])
            self._peers[-1].setblocking(False)
        for peer in list(self._peers):
            try:
                peer.send(data)
            except OSError:
                peer.close()
                self._peers.remove(peer)

    def receive(self) -> bytes:
        """Return what those have sent who are connected."""
        came = b""
        for peer in self._peers:
            with suppress(OSError):  # nothing, or it has gone; `send` sees that
                came += peer.recv(4096)
        return came

    @property
    def is_heard(self) -> bool:
        """Whether it takes in what is sent to it."""
        return self._listens

    def close(self) -> None:
        """Close all sockets."""
        for each in (*self._peers, self._socket):
            each.close()


class BoardLine:
    """The UDP socket of a board."""

    def __init__(self, settings: SteerBoardSettings) -> None:
        """Listen at the board's address.

        Raises:
            HardwareError: the port is taken.
        """
        self._socket = _bound(socket.SOCK_DGRAM, settings.destination, settings.address)
        self._computer: tuple[str, int] | None = None

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._socket.fileno()

    def receive(self) -> list[tuple[bytes, int]]:
        """Return the datagrams that have come, with their senders' ports."""
        came: list[tuple[bytes, int]] = []
        while len(came) < 64:
            try:
                data, self._computer = self._socket.recvfrom(2048)
            except BlockingIOError:
                break
            came.append((data, self._computer[1]))
        return came

    def send(self, output: Output) -> None:
        """Send to the computer that was heard last."""
        if self._computer is not None:
            try:
                self._socket.sendto(output.data, self._computer)
            except OSError:
                return

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class CanLine:
    """The CAN bus of an NMEA 2000 receiver."""

    def __init__(self, address: str) -> None:
        """Open it."""
        self._bus = open_can(address)

    def send(self, data: bytes) -> None:
        """Send a packed frame."""
        frame = unpacked(data)
        if frame is not None:
            self._bus.write(frame)
            self._bus.read()  # nobody else does

    def close(self) -> None:
        """Close the bus."""
        self._bus.close()


def _bound(kind: socket.SocketKind, place: tuple[str, int], address: str) -> socket.socket:
    """Return a socket at a place, which the configuration calls so.

    Raises:
        HardwareError: the port is taken, or the address is not this computer's.
    """
    bound = socket.socket(socket.AF_INET, kind)
    bound.setblocking(False)
    try:
        if kind is socket.SOCK_STREAM:
            bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # after a stand-in that ended just now
        bound.bind(place)
    except OSError as error:
        bound.close()
        raise HardwareError(
            f"the stand-in cannot be at {address} ({error.strerror}); end the program that is there"
        ) from None
    return bound


def _line(address: str) -> DataLine | CanLine:
    return CanLine(address) if address.startswith(CAN) else DataLine(address)


class StandIns:
    """All stand-in devices of a configuration behind their sockets."""

    def __init__(self, configuration: Configuration, machine: StandInMachine, pace: int) -> None:
        """Open the sockets.

        Raises:
            HardwareError: one of them cannot be opened.
        """
        devices = configuration.devices
        assert devices is not None
        self._machine = machine
        lines = {"tractor": devices.tractor_receiver.transport, "trailer": devices.trailer_receiver.transport}
        lines |= {SENSORS: devices.sensors.transport} if devices.sensors else {}
        boards = {"tractor": devices.tractor_board, "trailer": devices.trailer_board}
        self._lines = {name: _line(address) for name, address in lines.items()}
        self.boards = {body: BoardLine(settings) for body, settings in boards.items() if settings is not None}
        self._commanded = dict.fromkeys(self.boards, -math.inf)
        self._corrected: dict[str, tuple[DataLine, RtcmFramer]] = {}
        self._caster: Caster | None = None
        if devices.corrections is not None:
            self._correct(devices.corrections, pace)
        self._valve = DataLine(devices.bare_valve.transport) if devices.bare_valve else None
        if self._valve is not None:
            self._lines[BARE_VALVE] = self._valve

    @property
    def commanded(self) -> float:
        """When all steerings have been commanded last, even if only not to steer, s."""
        valves = self._machine.can.valves.values() if self._machine.can else ()
        return min([*self._commanded.values(), *(valve.heard for valve in valves)])

    def _correct(self, settings: CorrectionsSettings, pace: int) -> None:
        """Let the receivers that can be sent corrections need them, and be the caster where it is to be here."""
        for body in BODIES:
            line = self._lines[body]
            if isinstance(line, DataLine) and line.is_heard:
                self._corrected[body] = (line, RtcmFramer())
                self._machine.corrected[body] = -math.inf
        if is_loopback(settings.host):
            self._caster = stand_in_caster(settings, pace)

    def advance(self, now: float) -> None:
        """Do everything up to a time, s since the start."""
        for body, line in self.boards.items():
            for data, port in line.receive():
                if data.startswith(SET_POINT):
                    self._commanded[body] = now
                self._send(self._machine.receive(now, body, data, port))
        if self._valve is not None and self._machine.valve is not None:
            self._machine.valve.receive(now, self._valve.receive())
        for body, (receiver, framer) in self._corrected.items():
            if framer.feed(receiver.receive()):
                self._machine.corrected[body] = now
        heard, sent = self._machine.advance(now)
        for name, data in heard:
            if name in self._lines:
                self._lines[name].send(data)
        self._send(sent)

    def _send(self, outputs: list[tuple[str, Output]]) -> None:
        for body, output in outputs:
            self.boards[body].send(output)

    def close(self) -> None:
        """Close all sockets."""
        for line in self._lines.values():
            line.close()
        for board in self.boards.values():
            board.close()
        if self._caster is not None:
            self._caster.stop()


def _tell(driver: Driver, state: GateState) -> None:
    """Let the driver see the lamp, stand until the emergency stop was tried, and begin again after a stop."""
    rests = state.state is SupervisorState.STANDBY
    untried = Cause.EMERGENCY_UNTRIED.value in state.refusals and Cause.SHADOW.value not in state.refusals
    driver.told_to_stop = (bool(state.stop) and not rests) or untried
    if rests and driver.speed == 0.0 and not driver.told_to_stop:
        driver.begin_again()


def _lamp(orders: Orders, configuration: Configuration) -> Mailbox:
    """Open what the driver is told by, where the drive looks for it.

    Raises:
        HardwareError: another stand-in of these devices runs.
    """
    assert configuration.devices is not None
    try:
        return Mailbox(orders.socket(DRIVER) if orders.stand_ins else lamp_of(configuration.devices, orders.pace))
    except OSError as error:
        raise HardwareError(f"another stand-in of these devices runs ({error.strerror}); end it") from None


def main() -> int:
    """Be the machine of the orders on standard input."""
    return serve(Orders.model_validate_json(sys.stdin.read()))


def serve(
    orders: Orders,
    faults: Sequence[PlannedFault] = (),
    tell: Callable[[str], None] = lambda words: None,
    firmware: Firmware = Firmware.AIO_V4,
) -> int:
    """Be the machine until told to end; return an exit code.

    Args:
        orders: what is stood in for.
        faults: of the machine.
        tell: is given what happens when one begins.
        firmware: of all boards.

    Raises:
        ConfigurationError: the machine does not have the device that one is a fault of.
    """
    configuration = load_configuration(orders.configuration)
    path, _ = build_path(configuration)
    clock, isobus = orders.clock.from_now(), configuration.devices.isobus if configuration.devices else None
    bus = open_can(isobus.bus, clock) if isobus else None
    machine = stand_in_machine(configuration, path, local_frame(configuration), SEED, bus, firmware)
    machine.driver.wait = Driver.WAIT if orders.stand_ins else Driver.WAIT_UNTOLD
    plan = FaultPlan(faults, machine)
    ending, seen = Ending(), -math.inf
    try:
        lamp = _lamp(orders, configuration)
        stand_ins = StandIns(configuration, machine, orders.pace)
    except HardwareError as error:
        print(f"stand-in: {error}", file=sys.stderr)
        return 2
    schedule_first(_PRIORITY)
    while not ending.asked:
        for data in lamp.receive():
            state = decode(data, GateState)
            if isinstance(state, GateState):
                _tell(machine.driver, state)
                seen = clock()
        now = clock()
        machine.driver.attend(now, attended=now - max(seen, stand_ins.commanded) < _GONE)
        stand_ins.advance(now)
        for words in plan.look():
            tell(words)
        descriptors = [lamp.fileno(), *(line.fileno() for line in stand_ins.boards.values())]
        clock.wait(descriptors, min(machine.next_time - clock(), 0.05))
    for each in (stand_ins, lamp, bus):
        if each is not None:
            each.close()
    return 0


if __name__ == "__main__":
    sys.exit(told(main))
