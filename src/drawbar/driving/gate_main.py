"""The gate's process as a program: `python -m drawbar.driving.gate_main`, with its orders on standard input."""

import socket
import sys
from pathlib import Path

from drawbar.driving.orders import DRIVER, GATE, RECORDER, GateOrders
from drawbar.machine.hardware.shared_socket import own_sources, share
from drawbar.protocols.agopengps.network import COMPUTER_PORT
from drawbar.safety.channels import ControllerChannel, DeskChannel, open_desk
from drawbar.safety.envelope import Bounds
from drawbar.safety.gate_process import run
from drawbar.safety.machine_gate import Gate
from drawbar.safety.wires import Wire
from drawbar.transports.open import open_transport
from drawbar.transports.udp import UdpTransport


def main() -> int:
    """Open the actuators and run the gate; return its exit code."""
    orders = GateOrders.model_validate_json(sys.stdin.read())
    folder = Path(orders.folder)
    desk = DeskChannel(open_desk(str(folder / GATE)), (str(folder / RECORDER), str(folder / DRIVER)))
    gate = Gate(
        orders.safety,
        Bounds(wheelbase=orders.wheelbase, tractor_limit=orders.tractor_limit, trailer_limit=orders.trailer_limit),
        wires(orders),
        ControllerChannel(socket.socket(fileno=orders.controller)),
        desk,
    )
    return run(gate, orders.safety)


def wires(orders: GateOrders) -> list[Wire]:
    """Open the transports of all actuators; boards that listen at one place share one socket.

    Raises:
        HardwareError: a port is taken.
    """
    boards = {"tractor": orders.tractor_board, "trailer": orders.trailer_board}
    opened: list[Wire] = []
    for listen in sorted({board.listen for board in boards.values() if board is not None}):
        here = {body: board for body, board in boards.items() if board is not None and board.listen == listen}
        line = open_transport(next(iter(here.values())).transport)
        assert isinstance(line, UdpTransport)
        peers = [board.destination for board in here.values()]
        own = own_sources(peers, COMPUTER_PORT)
        for (body, board), transport in zip(here.items(), share(line, peers), strict=True):
            actuator = board.actuator(own)
            tractor, trailer = (actuator, None) if body == "tractor" else (None, actuator)
            opened.append(Wire(transport=transport, tractor=tractor, trailer=trailer))
    return opened


if __name__ == "__main__":
    sys.exit(main())
