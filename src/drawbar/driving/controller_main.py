"""The controller's process as a program: fixes and the gate's states in, commands out.

`python -m drawbar.driving.controller_main DESCRIPTOR`, its end of the pair with the gate; its orders on standard input.
"""

import select
import socket
import sys
import time

import msgspec

from drawbar.config import load_configuration
from drawbar.driving.beat import Beat
from drawbar.driving.control_loop import ControlLoop
from drawbar.driving.controller import Controller
from drawbar.driving.ending import Ending
from drawbar.driving.letters import Step, pack
from drawbar.driving.mail import Mailbox
from drawbar.driving.orders import CONSOLE, CONTROLLER, FRONT_END, GATE, RECORDER, Orders
from drawbar.driving.wiggled import has_passed
from drawbar.machine.hardware.sampler import Sampler
from drawbar.messages import ControllerState, Fixes, GateState, Message, Role, decode, encode
from drawbar.realtime import prepare
from drawbar.recording.log import encode_special
from drawbar.signals import StepRecord
from drawbar.simulation import build_path

_LONGEST_WAIT = 100_000_000
"""ns"""


def main() -> int:
    """Run the control loop until told to end, or until the gate is gone."""
    orders = Orders.model_validate_json(sys.stdin.read())
    gate = socket.socket(fileno=int(sys.argv[1]))
    gate.setblocking(False)
    configuration = load_configuration(orders.configuration)
    mailbox, recorder = Mailbox(orders.socket(CONTROLLER)), orders.socket(RECORDER)
    encoder = msgspec.json.Encoder(enc_hook=encode_special)
    beat, ending = Beat(Role.CONTROLLER, mailbox, orders.socket(GATE)), Ending()

    def send(message: Message) -> None:
        record = encode(message)
        try:
            gate.send(record)
        except BlockingIOError:
            mailbox.lost += 1
        except OSError:
            ending.asked = True
        mailbox.send(recorder, record)
        if isinstance(message, ControllerState):
            for place in (FRONT_END, CONSOLE):
                mailbox.send(orders.socket(place), record)

    def keep(record: StepRecord) -> None:
        letter = pack(Step(time=time.monotonic_ns(), data=encoder.encode(record)))
        mailbox.send(recorder, letter)
        mailbox.send(orders.socket(CONSOLE), letter)

    path, _ = build_path(configuration)
    fingerprint, wiggled = configuration.safety.fingerprint(), has_passed(configuration)
    controller = Controller(configuration, path, fingerprint, wiggled=wiggled)
    loop = ControlLoop(controller, Sampler(configuration.sample_time), send=send, record=keep, clock=time.monotonic_ns)
    for word in prepare(max(configuration.safety.timing.priority - 10, 0)):
        print(f"controller: {word}", file=sys.stderr)
    while not ending.asked:
        now = time.monotonic_ns()
        ending.asked |= not _hear_gate(gate, loop, beat)
        for data in mailbox.receive():
            fixes = decode(data, Fixes)
            if isinstance(fixes, Fixes):
                loop.hear_fixes(fixes)
        if now >= loop.due:
            loop.pass_time(now)
        beat.pass_time(now)
        until = min(loop.due, beat.due, time.monotonic_ns() + _LONGEST_WAIT)
        select.select([gate.fileno(), mailbox.fileno()], [], [], max(until - time.monotonic_ns(), 0) * 1e-9)
    mailbox.close()
    return 0


def _hear_gate(gate: socket.socket, loop: ControlLoop, beat: Beat) -> bool:
    """Take in what the gate has sent; return whether it is still there."""
    while True:
        try:
            data = gate.recv(4096)
        except BlockingIOError:
            return True
        except OSError:
            return False
        if not data:
            return False
        state = decode(data, GateState)
        if isinstance(state, GateState):
            beat.state = state.state
            loop.hear_gate(state)


if __name__ == "__main__":
    sys.exit(main())
