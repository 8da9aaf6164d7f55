"""A gate as a process, with the processes and sockets around it."""

import contextlib
import json
import select
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path

from waiting import until

from drawbar.messages import Action, GateState, Heartbeat, OperatorMessage, Role, SupervisorState
from drawbar.messages.records import decode, encode
from drawbar.safety.channels import controller_pair
from drawbar.safety.settings import SafetySettings
from drawbar.transports.address import UdpAddress
from drawbar.transports.udp import UdpTransport

WAIT = 60.0
"""s; until a process has ended"""
_HARNESS = Path(__file__).parent
_HEARD = 5.0
"""s; no longer is the wire listened to"""
_CHANGES = {
    "engage": {"hold": 0.1, "fixed": 0.0, "solved": 1, "emergency_test": False, "recorder": False},
    "drive": {"easing": 0.1, "operator": 10.0, "engaging": 10.0},
    "timing": {"late": 2.0, "lease": 20.0},
}
"""an operator who need not wait, on a computer that may be busy with other tests"""


class NotDrivingError(Exception):
    """It has not come to a state."""


class Machine:
    """A gate's process, a controller's, the wire to the actuator, and an operator: all of them real."""

    def __init__(self, folder, **order):
        self.folder, self.nonce, self.state = folder, 0, None
        self.wire, self.gate_wire = (UdpTransport(UdpAddress(host="127.0.0.1", port=0)) for _ in range(2))
        self.front = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.front.bind(str(folder / "front"))
        self.front.setblocking(False)
        gate_end, controller_end = controller_pair()
        settings = SafetySettings.model_validate(_CHANGES)
        order |= {
            "port": self.wire.port, "controller": gate_end.fileno(), "operators": str(folder / "operators"),
            "subscribers": [str(folder / "front"), str(folder / "guard")], "settings": _CHANGES,
        }  # fmt: skip
        self.gate = self._start("gate_runner.py", gate_end, json.dumps(order))
        self.controller = self._start(
            "controller_runner.py", controller_end, str(controller_end.fileno()), str(settings.fingerprint())
        )
        gate_end.close()
        controller_end.close()

    def _start(self, script, end, *arguments):
        command = [sys.executable, str(_HARNESS / script), *arguments]
        with (self.folder / script).open("wb") as errors:
            return subprocess.Popen(command, pass_fds=[end.fileno()], stderr=errors)

    def frames(self, seconds):
        """Yield when each datagram came on the wire and whether it says to steer, until nothing came for so long.

        A gate that goes on sends without end: at most 5 seconds are listened to.
        """
        end = time.monotonic() + _HEARD
        while time.monotonic() < end and select.select([self.wire], [], [], seconds)[0]:
            for piece in self.wire.read():
                yield piece.time, struct.unpack("<Bd", piece.data)[0] == 1

    def listen(self):
        """Take in the gate's newest state and what is on the wire."""
        self.wire.read()
        with contextlib.suppress(BlockingIOError):
            while True:
                self.state = decode(self.front.recv(4096), GateState)

    def ask(self, action):
        self.nonce += 1
        now = time.monotonic_ns()
        message = OperatorMessage(
            time=now, valid_until=now + 10**9, action=action, lease=5, nonce=self.nonce,
            seen_sequence=self.state.sequence, seen_time=self.state.time,
        )  # fmt: skip
        return self.send(message)

    def ask_until_it_is_taken(self, action):
        """Ask again and again, while the gate's socket is full of what others send."""
        while not self.ask(action):
            pass

    def gate_place(self):
        """Return host and port from which the gate speaks to the actuator."""
        piece = until(self.wire.read)[0]
        host, _, port = piece.source.partition(":")
        return host, int(port)

    def guards(self):
        now = time.monotonic_ns()
        self.send(Heartbeat(time=now, valid_until=now + 10**9, role=Role.GUARD, healthy=1, state=SupervisorState.BOOT))

    def send(self, message):
        """Return the bytes that the gate's socket has taken."""
        with contextlib.suppress(OSError):  # a gate that is ending does not listen
            return self.front.sendto(encode(message), str(self.folder / "operators"))
        return 0

    def come_to(self, state, seconds=20.0):
        end = time.monotonic() + seconds
        while self.state is None or self.state.state is not state:
            faulty = self.state is not None and self.state.state is SupervisorState.FAULT
            if faulty or time.monotonic() > end or self.gate.poll() is not None:
                raise NotDrivingError(self.state, (self.folder / "gate_runner.py").read_text())
            time.sleep(0.02)
            self.listen()
            self.guards()
            if self.state is not None and state is SupervisorState.ACTIVE:
                asked = {True: Action.ENGAGE, False: Action.ARM}[bool(self.state.armed)]
                self.ask(asked if self.state.state is SupervisorState.READY else Action.PRESENT)
            elif self.state is not None:
                self.ask(Action.PRESENT)

    def close(self):
        for process in (self.controller, self.gate):
            process.kill()
            process.wait(WAIT)
        self.wire.close()
        self.gate_wire.close()
        self.front.close()
