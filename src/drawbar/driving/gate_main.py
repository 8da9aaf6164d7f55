"""The gate's process as a program: `python -m drawbar.driving.gate_main`, with its orders on standard input."""

import socket
import sys
from pathlib import Path

from drawbar.driving.actuators import board_wires, isobus_wire, listened
from drawbar.driving.ending import told
from drawbar.driving.orders import DRIVER, GATE, GUARD, RECORDER, GateOrders
from drawbar.safety.channels import ControllerChannel, DeskChannel, open_desk
from drawbar.safety.envelope import Bounds
from drawbar.safety.gate_process import run
from drawbar.safety.machine_gate import Gate
from drawbar.safety.wires import Wire
from drawbar.transports.open import open_can


def main() -> int:
    """Open the actuators and run the gate; return its exit code."""
    orders = GateOrders.model_validate_json(sys.stdin.read())
    folder = Path(orders.folder)
    listeners = (*(str(folder / name) for name in (GUARD, RECORDER)), orders.driver or str(folder / DRIVER))
    desk = DeskChannel(open_desk(str(folder / GATE)), listeners)
    gate = Gate(
        orders.safety,
        Bounds(wheelbase=orders.wheelbase, tractor_limit=orders.tractor_limit, trailer_limit=orders.trailer_limit),
        wires(orders),
        ControllerChannel(socket.socket(fileno=orders.controller)),
        desk,
    )
    return run(gate, orders.safety, orders.clock)


def wires(orders: GateOrders) -> list[Wire]:
    """Open the transports of all actuators, of a shadow only to listen.

    Raises:
        HardwareError: a port is taken.
    """
    boards, clock = {"tractor": orders.tractor_board, "trailer": orders.trailer_board}, orders.clock
    opened = board_wires(boards, clock, listens=orders.shadow, sentences=orders.sentences)
    if orders.isobus is not None:
        limit = orders.safety.envelope.speed if orders.drives else None
        opened.append(isobus_wire(orders.isobus, limit, open_can(orders.isobus.bus, clock)))
    return [listened(wire) for wire in opened] if orders.shadow else opened


if __name__ == "__main__":
    sys.exit(told(main))
