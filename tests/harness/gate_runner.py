"""A gate in a process of its own, with a tractor's actuator that speaks over UDP: python gate_runner.py JSON."""

import json
import math
import socket
import struct
import sys
import time as clock

from drawbar.protocols.actuator import Readiness, SteeringActuator, SteeringReport
from drawbar.safety.channels import ControllerChannel, OperatorChannel, open_operator_socket
from drawbar.safety.envelope import Bounds
from drawbar.safety.gate_process import run
from drawbar.safety.machine_gate import Gate
from drawbar.safety.settings import SafetySettings
from drawbar.safety.wires import Wire
from drawbar.transports.base import Received, Transport
from drawbar.transports.clock import MachineClock


class Udp(Transport):
    """Datagrams to one port of this computer."""

    def __init__(self, port):
        self.connected, self._to = True, ("127.0.0.1", port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)

    def fileno(self):
        return self._socket.fileno()

    def read(self):
        found = []
        while len(found) < 64:
            try:
                found.append(Received(time=clock.monotonic(), data=self._socket.recv(4096)))
            except OSError:
                break
        return found

    def write(self, data):
        return self._socket.sendto(data, self._to) == len(data)

    def close(self):
        self._socket.close()


class Steering(SteeringActuator[bytes]):
    """Steers at once: 1 or 0, and the set point."""

    def __init__(self, fails_at):
        self.dropped, self._on, self._angle, self._fails_at = {"unknown": 0}, False, 0.0, fails_at

    def receive(self, time, frame, source=""):
        self.dropped["unknown"] += 1

    def send(self, time, request):
        self._on = request.steer
        self._angle = request.angle if request.steer else self._angle
        return [struct.pack("<Bd", request.steer, request.angle if request.steer else math.nan)]

    def report(self, time):
        if self._fails_at == "report" and self._on:
            raise RuntimeError("the program of the actuator fails")
        return SteeringReport(angle=self._angle, angle_time=time, engaged=self._on, readiness=Readiness.READY)


def main(order):
    settings = SafetySettings.model_validate(order["settings"])
    bounds = Bounds(wheelbase=1.4, tractor_limit=0.5, trailer_limit=0.3)
    gate = Gate(
        settings,
        bounds,
        [Wire(transport=Udp(order["port"]), tractor=Steering(order.get("fails_at")))],
        ControllerChannel(socket.socket(fileno=order["controller"])),
        OperatorChannel(open_operator_socket(order["operators"]), tuple(order["subscribers"])),
    )
    if order.get("fails_at") == "tick":
        publish = gate._publish

        def fail(*given):
            publish(*given)
            if gate.engagement.steers:
                raise RuntimeError("the gate's own program fails")

        gate._publish = fail
    return run(gate, settings, MachineClock())


if __name__ == "__main__":
    sys.exit(main(json.loads(sys.argv[1])))
