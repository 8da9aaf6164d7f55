"""The controller's process as a program: fixes and the gate's states in, commands out.

`python -m drawbar.driving.controller_main DESCRIPTOR`, its end of the pair with the gate; its orders on standard input.
"""

import socket
import sys
from collections.abc import Iterator, Mapping

from drawbar.config import load_configuration
from drawbar.driving.beat import Beat
from drawbar.driving.control_loop import ControlLoop
from drawbar.driving.controller import Controller
from drawbar.driving.ending import Ending, told
from drawbar.driving.letters import Step, Sureness, pack
from drawbar.driving.mail import Mailbox
from drawbar.driving.orders import CONSOLE, CONTROLLER, FRONT_END, GATE, RECORDER, Orders
from drawbar.driving.wiggled import has_passed
from drawbar.machine.hardware.sampler import Sampler
from drawbar.message_records import decode, encode
from drawbar.messages import ControllerState, Fixes, GateState, Message, Role
from drawbar.realtime import prepare, say
from drawbar.recording.drive_records import Happening, Kind, Order
from drawbar.signals import StepRecord
from drawbar.simulation import build_path
from drawbar.step.layout import packed

_TOGETHER = 32
"""of what was done is told at once; more than in a step"""
_LONGEST_WAIT = 100_000_000
"""ns"""
_LOOK = 1_000_000_000
"""between two looks, while nothing is steered, whether the wiggle test is passed, ns"""


def main() -> int:
    """Run the control loop until told to end, or until the gate is gone."""
    orders = Orders.model_validate_json(sys.stdin.read())
    gate = socket.socket(fileno=int(sys.argv[1]))
    gate.setblocking(False)
    configuration, clock = load_configuration(orders.configuration), orders.clock
    mailbox = Mailbox(orders.socket(CONTROLLER))
    beat, ending, words = Beat(Role.CONTROLLER, mailbox, orders.socket(GATE)), Ending(), Words(gate, mailbox, orders)
    path, _ = build_path(configuration)
    controller, look = Controller(configuration, path, configuration.safety.fingerprint()), 0
    loop = ControlLoop(
        controller,
        Sampler(configuration.sample_time, has_trailer=configuration.has_trailer_receiver),
        send=words.send,
        record=lambda record: words.keep(record, controller.sureness.parameters),
        clock=clock.nanoseconds,
        tell=words.tell,
    )
    for word in prepare(max(configuration.safety.timing.priority - 10, 0)):
        say(f"controller: {word}")
    while not (ending.asked or words.gate_is_gone):
        now = clock.nanoseconds()
        if now >= look and not controller.engaged:
            look, controller.wiggled = now + _LOOK, has_passed(configuration)
        _hear_gate(gate, words, beat, loop)
        _hear_receivers(mailbox, loop)
        if now >= loop.due:
            loop.pass_time(now)
        beat.pass_time(now)
        wait = min(min(loop.due, beat.due) - clock.nanoseconds(), _LONGEST_WAIT)
        clock.wait([gate.fileno(), mailbox.fileno()], wait * 1e-9)
    words.tell_done()
    mailbox.close()
    return 0


def _hear_gate(gate: socket.socket, words: "Words", beat: Beat, loop: ControlLoop) -> None:
    for data in arrived(gate):
        state = decode(data, GateState)
        if isinstance(state, GateState):
            words.repeat(data)
            beat.state = state.state
            loop.hear_gate(state)
        words.gate_is_gone |= not data


def _hear_receivers(mailbox: Mailbox, loop: ControlLoop) -> None:
    for data in mailbox.receive():
        fixes = decode(data, Fixes)
        if isinstance(fixes, Fixes):
            loop.hear_fixes(fixes)


class Words:
    """What the controller says: to the gate at once, to the recorder without fail, to displays if they read."""

    def __init__(self, gate: socket.socket, mailbox: Mailbox, orders: Orders) -> None:
        """Take the gate's end, the own mailbox and where the others are."""
        self._gate, self._mailbox = gate, mailbox
        self._recorder, self._console = orders.socket(RECORDER), orders.socket(CONSOLE)
        self._displays = (orders.socket(FRONT_END), self._console)
        self._clock = orders.clock
        self._done: list[Happening] = []
        self.gate_is_gone = False

    def send(self, message: Message) -> None:
        """Send a message to the gate."""
        record = encode(message)
        try:
            self._gate.send(record)
        except BlockingIOError:
            self._mailbox.lost += 1
        except OSError:
            self.gate_is_gone = True
        self._mailbox.post(self._recorder, record)
        if isinstance(message, ControllerState):
            for place in self._displays:
                self._mailbox.send(place, record)

    def tell(self, kind: Kind, sequence: int) -> None:
        """Note what is done now; the recorder is told with the next step, or soon."""
        self._done.append(Happening(kind=kind, time=self._clock.nanoseconds(), sequence=sequence))
        if len(self._done) >= _TOGETHER:
            self.tell_done()

    def tell_done(self) -> None:
        """Tell the recorder what has been done."""
        if self._done:
            self._mailbox.post(self._recorder, pack(Order(tuple(self._done))))
            self._done.clear()

    def keep(self, record: StepRecord, deviations: Mapping[str, float]) -> None:
        """Have a step recorded, and shown with the standard deviations of fields of its estimate."""
        self.tell_done()
        letter = pack(Step(time=self._clock.nanoseconds(), data=packed(record)))
        self._mailbox.post(self._recorder, letter)
        for shown in (pack(Sureness(deviations)), letter):
            self._mailbox.send(self._console, shown)

    def repeat(self, record: bytes) -> None:
        """Have a state of the gate recorded: the gate itself does not wait for a recorder that is busy."""
        self._mailbox.post(self._recorder, record)


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
    sys.exit(told(main))
