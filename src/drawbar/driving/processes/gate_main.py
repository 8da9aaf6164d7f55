"""The gate's process as a program.

`python -m drawbar.driving.processes.gate_main`, with its options on standard input.
"""

import socket
import sys
from pathlib import Path

from drawbar.driving.devices.actuators import board_sockets, gate_wires
from drawbar.driving.messaging.process_options import BOARDS, DRIVER, GATE, GUARD, RECORDER, GateOptions
from drawbar.driving.messaging.socket_passing import pass_socket
from drawbar.driving.processes.shutdown import run_program
from drawbar.safety.channels import ControllerChannel, OperatorChannel, open_operator_socket
from drawbar.safety.envelope import Bounds
from drawbar.safety.gate_process import run
from drawbar.safety.machine_gate import Gate


def main() -> int:
    """Open the actuators and run the gate; return its exit code."""
    options = GateOptions.model_validate_json(sys.stdin.buffer.read())
    folder = Path(options.folder)
    listeners = (*(str(folder / name) for name in (GUARD, RECORDER)), options.driver or str(folder / DRIVER))
    wires = gate_wires(options)
    operators = OperatorChannel(open_operator_socket(str(folder / GATE)), listeners)  # only now: it shows that it runs
    for body, descriptor in board_sockets(wires, options):
        pass_socket(str(folder / BOARDS), body, descriptor)
    gate = Gate(
        options.safety,
        Bounds(wheelbase=options.wheelbase, tractor_limit=options.tractor_limit, trailer_limit=options.trailer_limit),
        wires,
        ControllerChannel(socket.socket(fileno=options.controller)),
        operators,
    )
    return run(gate, options.safety, options.clock)


if __name__ == "__main__":
    sys.exit(run_program(main))
