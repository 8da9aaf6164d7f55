"""Actuators: the wires to what the devices of a configuration steer and drive with. Without numpy: the gate uses it."""

import time
from collections.abc import Iterable, Iterator
from contextlib import suppress

from drawbar.driving.messaging.process_options import GateOptions
from drawbar.errors import HardwareError
from drawbar.machine.hardware.isobus import IsobusSettings, guidance_valve
from drawbar.machine.hardware.sentences import SentenceRelay
from drawbar.machine.hardware.shared_socket import own_sources, share
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.protocols.agopengps.network import COMPUTER_PORT
from drawbar.protocols.isobus.speed_actuator import MachineSpeed
from drawbar.protocols.listened import ListenedSteering
from drawbar.safety.wires import Wire
from drawbar.transports.base import CanBus, Transport
from drawbar.transports.clock import Clock
from drawbar.transports.open import open_can, open_transport
from drawbar.transports.udp import UdpTransport


def board_wires(
    boards: dict[str, SteerBoardSettings | None],
    clock: Clock = time.monotonic,
    *,
    listens: bool = False,
    sentences: str = "",
) -> list[Wire]:
    """Open the transports of boards by the names of their bodies; those that listen at one place share one socket.

    Args:
        boards: their settings.
        clock: of what they send, s.
        listens: open sockets that receive from the boards, and send nothing.
        sentences: path to hand the boards' sentences to, for receivers on them; empty: there are none.

    Raises:
        HardwareError: a port is taken.
    """
    opened: list[Wire] = []
    for listen in sorted({board.listen for board in boards.values() if board is not None}):
        here = {body: board for body, board in boards.items() if board is not None and board.listen == listen}
        first = next(iter(here.values()))
        line = open_transport(first.receive_only if listens else first.transport, clock)
        assert isinstance(line, UdpTransport)
        relayed = SentenceRelay(line, sentences) if sentences else line
        peers = [board.destination for board in here.values()]
        own = own_sources(peers, COMPUTER_PORT)
        listeners = [] if listens else _broadcast_listeners(here.values(), clock)
        for (body, board), transport in zip(here.items(), share(relayed, peers, listeners), strict=True):
            actuator = board.actuator(own)
            tractor, trailer = (actuator, None) if body == "tractor" else (None, actuator)
            opened.append(Wire(transport=transport, tractor=tractor, trailer=trailer))
    return opened


def _broadcast_listeners(boards: Iterable[SteerBoardSettings], clock: Clock) -> list[Transport]:
    """Open the sockets that receive what another computer broadcasts to the boards: set points.

    There is none where another program has the port or this computer is not in that network.
    """
    listeners: list[Transport] = []
    for address in sorted({board.broadcasts for board in boards}):
        with suppress(HardwareError):
            listeners.append(open_transport(address, clock))
    return listeners


def isobus_wire(settings: IsobusSettings, speed_limit: float | None, bus: CanBus | None = None) -> Wire:
    """Return the wire to all that is on the ISOBUS, under one address.

    Args:
        settings: of the bus and its valves.
        speed_limit: largest speed to ask the tractor for, m/s; None: the driver drives.
        bus: open; None: the one that the settings name is opened.
    """
    node = settings.node()
    tractor, trailer = settings.tractor_valve, settings.trailer_valve
    return Wire(
        transport=bus or open_can(settings.bus),
        tractor=guidance_valve(node, tractor) if tractor else None,
        trailer=guidance_valve(node, trailer) if trailer else None,
        speed=MachineSpeed(node, speed_limit) if speed_limit is not None else None,
    )


def listened(wire: Wire) -> Wire:
    """Return a wire on which nothing is sent: its steerings are listened to, and there is nothing to drive with."""
    return Wire(
        transport=wire.transport,
        tractor=ListenedSteering(wire.tractor) if wire.tractor else None,
        trailer=ListenedSteering(wire.trailer) if wire.trailer else None,
    )


def gate_wires(options: GateOptions) -> list[Wire]:
    """Open the transports of all actuators that the gate gets, of a shadow only to listen.

    Raises:
        HardwareError: a port is taken.
    """
    boards, clock = {"tractor": options.tractor_board, "trailer": options.trailer_board}, options.clock
    opened = board_wires(boards, clock, listens=options.shadow, sentences=options.sentences)
    if options.isobus is not None:
        limit = options.safety.envelope.speed if options.drives else None
        opened.append(isobus_wire(options.isobus, limit, open_can(options.isobus.bus, clock)))
    return [listened(wire) for wire in opened] if options.shadow else opened


def board_sockets(wires: Iterable[Wire], options: GateOptions) -> Iterator[tuple[str, int]]:
    """Yield the body that each board steers, and the descriptor of the socket from which it is sent set points."""
    for wire in wires:
        steered = {"tractor": wire.tractor, "trailer": wire.trailer}
        for body in options.boards:
            if steered[body] is not None:
                yield body, wire.transport.fileno()
