"""The controller's process as a program: fixes and the gate's states in, commands out.

`python -m drawbar.driving.processes.controller_main DESCRIPTOR`, with its options on standard input. The descriptor is
that of its end of the pair with the gate.
"""

import socket
import sys
from collections.abc import Iterator, Mapping

from drawbar.config import load_configuration
from drawbar.driving.loop.control_loop import ControlLoop
from drawbar.driving.loop.controller import Controller
from drawbar.driving.loop.field_fence import build_fence
from drawbar.driving.messaging.datagrams import EstimateDeviations, PackedStep, pack
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.heartbeat import HeartbeatSender
from drawbar.driving.messaging.process_options import CONSOLE, CONTROLLER, FRONT_END, GATE, RECORDER, ProcessOptions
from drawbar.driving.preparation.wiggle_record import has_passed
from drawbar.driving.processes.shutdown import ShutdownRequest, run_program
from drawbar.machine.hardware.sampler import Sampler
from drawbar.messages import CommandMessage, ControllerState, Fixes, GateState, Message, Role
from drawbar.messages.records import decode, encode
from drawbar.realtime import prepare, say
from drawbar.recording.drive_records import Happening, Kind, Order
from drawbar.signals import StepRecord
from drawbar.simulation import build_path
from drawbar.step.layout import packed

_TOGETHER = 32
"""of what was done is sent at once; more than in a step"""
_LONGEST_WAIT = 100_000_000
"""ns"""
_LOOK = 1_000_000_000
"""between two looks, while nothing is steered, whether the wiggle test is passed, ns"""


def main() -> int:
    """Run the control loop until told to end, or until the gate is gone."""
    options = ProcessOptions.model_validate_json(sys.stdin.buffer.read())
    gate = socket.socket(fileno=int(sys.argv[1]))
    gate.setblocking(False)
    configuration, clock = load_configuration(options.configuration), options.clock
    endpoint = Endpoint(options.socket(CONTROLLER))
    heartbeat, shutdown = HeartbeatSender(Role.CONTROLLER, endpoint, options.socket(GATE)), ShutdownRequest()
    outputs = Outputs(gate, endpoint, options)
    path, _ = build_path(configuration)
    fence, look = build_fence(configuration), 0
    controller = Controller(configuration, path, configuration.safety.fingerprint(), fence)
    loop = ControlLoop(
        controller,
        Sampler(configuration.sample_time, has_trailer=configuration.has_trailer_receiver),
        send=outputs.send,
        record=lambda record: outputs.record_step(record, controller.uncertainty.parameters),
        clock=clock.nanoseconds,
        tell=outputs.note,
        send_again=outputs.send_again,
    )
    for word in prepare(max(configuration.safety.timing.priority - 10, 0)):
        say(f"controller: {word}")
    while not (shutdown.asked or outputs.gate_is_gone):
        now = clock.nanoseconds()
        if now >= look and not controller.engaged:
            look, controller.wiggled = now + _LOOK, has_passed(configuration)
        _receive_gate(gate, outputs, heartbeat, loop)
        _receive_receivers(endpoint, loop)
        if now >= loop.due:
            loop.pass_time(now)
        heartbeat.pass_time(now)
        wait = min(min(loop.due, heartbeat.due) - clock.nanoseconds(), _LONGEST_WAIT)
        clock.wait([gate.fileno(), endpoint.fileno()], wait * 1e-9)
    outputs.send_order()
    endpoint.close()
    return 0


def _receive_gate(gate: socket.socket, outputs: "Outputs", heartbeat: HeartbeatSender, loop: ControlLoop) -> None:
    for data in arrived(gate):
        state = decode(data, GateState)
        if isinstance(state, GateState):
            outputs.record_gate(data)
            heartbeat.state = state.state
            loop.receive_gate(state)
        outputs.gate_is_gone |= not data


def _receive_receivers(endpoint: Endpoint, loop: ControlLoop) -> None:
    for data in endpoint.receive():
        fixes = decode(data, Fixes)
        if isinstance(fixes, Fixes):
            loop.receive_fixes(fixes)


class Outputs:
    """What the controller sends: to the gate at once, to the recorder without fail, to displays if they read."""

    def __init__(self, gate: socket.socket, endpoint: Endpoint, options: ProcessOptions) -> None:
        """Take the gate's end, the own endpoint and where the others are."""
        self._gate, self._endpoint = gate, endpoint
        self._recorder, self._console = options.socket(RECORDER), options.socket(CONSOLE)
        self._displays = (options.socket(FRONT_END), self._console)
        self._clock = options.clock
        self._done: list[Happening] = []
        self._recorded: CommandMessage | None = None
        """the newest command in the log"""
        self.gate_is_gone = False

    def send(self, message: Message) -> None:
        """Send a message to the gate, and have it recorded."""
        record = encode(message)
        self._send_to_gate(record)
        self._endpoint.send_queued(self._recorder, record)
        if isinstance(message, CommandMessage):
            self._recorded = message
        if isinstance(message, ControllerState):
            for place in self._displays:
                self._endpoint.send(place, record)

    def send_again(self, command: CommandMessage) -> None:
        """Send the newest command to the gate again; it is recorded where it asks for something else than before."""
        if self._recorded is None or not command.repeats(self._recorded):
            self.send(command)
        else:
            self._send_to_gate(encode(command))

    def _send_to_gate(self, record: bytes) -> None:
        try:
            self._gate.send(record)
        except BlockingIOError:
            self._endpoint.lost += 1
        except OSError:
            self.gate_is_gone = True

    def note(self, kind: Kind, sequence: int) -> None:
        """Note what is done now; it is sent to the recorder with the next step, or soon."""
        self._done.append(Happening(kind=kind, time=self._clock.nanoseconds(), sequence=sequence))
        if len(self._done) >= _TOGETHER:
            self.send_order()

    def send_order(self) -> None:
        """Send the recorder what has been done."""
        if self._done:
            self._endpoint.send_queued(self._recorder, pack(Order(tuple(self._done))))
            self._done.clear()

    def record_step(self, record: StepRecord, deviations: Mapping[str, float]) -> None:
        """Have a step recorded, and shown with the standard deviations of fields of its estimate."""
        self.send_order()
        datagram = pack(PackedStep(time=self._clock.nanoseconds(), data=packed(record)))
        self._endpoint.send_queued(self._recorder, datagram)
        for shown in (pack(EstimateDeviations(deviations)), datagram):
            self._endpoint.send(self._console, shown)

    def record_gate(self, record: bytes) -> None:
        """Have a state of the gate recorded: the gate itself does not wait for a recorder that is busy."""
        self._endpoint.send_queued(self._recorder, record)


def arrived(gate: socket.socket) -> Iterator[bytes]:
    """Yield the records that the gate has sent; an empty one at its end."""
    while True:
        try:
            data = gate.recv(4096)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        yield data
        if not data:
            return


if __name__ == "__main__":
    sys.exit(run_program(main))
