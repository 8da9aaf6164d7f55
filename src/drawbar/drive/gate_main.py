"""The gate's process as a program: `python -m drawbar.drive.gate_main`, with its orders on standard input."""

import socket
import sys
from pathlib import Path

from drawbar.drive.orders import DRIVER, GATE, RECORDER, GateOrders
from drawbar.safety.channels import ControllerChannel, DeskChannel, open_desk
from drawbar.safety.envelope import Bounds
from drawbar.safety.gate_process import run
from drawbar.safety.machine_gate import Gate
from drawbar.safety.wires import Wire
from drawbar.transports.open import open_transport


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
    """Open the transports of all actuators."""
    opened: list[Wire] = []
    if orders.tractor_board is not None:
        board = orders.tractor_board
        opened.append(Wire(transport=open_transport(board.transport), tractor=board.actuator()))
    if orders.trailer_board is not None:
        board = orders.trailer_board
        opened.append(Wire(transport=open_transport(board.transport), trailer=board.actuator()))
    return opened


if __name__ == "__main__":
    sys.exit(main())
