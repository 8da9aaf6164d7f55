"""The guard's process as a program: releases the boards when the gate, which steers them, is killed or frozen.

`python -m drawbar.driving.processes.guard_main`, with the gate's options on standard input. The gate sends its state at
each tick; when it steers and sends nothing for as long as it may be late, off frames go to the boards until it sends
again, for `timing.off` seconds at most: from the gate's own sockets, passed to it, since AiO_26 obeys no other port.
An ISOBUS valve watches itself, within 200 ms. The guard runs beside the gate, not within, and sends it heartbeats
and has the sockets: else the gate does not engage.
"""

import math
import socket
import sys
from pathlib import Path

from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.heartbeat import HeartbeatSender
from drawbar.driving.messaging.process_options import BOARDS, GATE, GUARD, GateOptions
from drawbar.driving.messaging.socket_passing import SocketReceiver
from drawbar.driving.processes.shutdown import ShutdownRequest, run_program
from drawbar.messages import GateState, Role
from drawbar.messages.records import decode
from drawbar.protocols.agopengps.steering import SteerCommand
from drawbar.realtime import prepare, say
from drawbar.safety.settings import TimingSettings

OFF = SteerCommand(steer=False, angle=0.0, speed=0.0).encode()
_AGAIN = 0.1
"""between two off frames, s"""
_LOOK = 0.25
"""longest time without looking whether to end, or sending a heartbeat to the gate, s"""


class Guard:
    """Decides when the boards are to be released; times are monotonic, s."""

    def __init__(self, timing: TimingSettings) -> None:
        """Begin with a gate that has sent nothing, and does not steer."""
        self._patience, self._off = timing.tick + timing.late, timing.off
        self._received, self._said, self._steers = -math.inf, -math.inf, False

    def receive_state(self, time: float, state: GateState) -> None:
        """Take in the newest state of the gate."""
        self._received, self._said, self._steers = time, -math.inf, bool(state.steers)

    @property
    def due(self) -> float:
        """When an off frame is to be sent unless the gate sends its state; infinity: not at all."""
        due = max(self._received + self._patience, self._said + _AGAIN)
        return due if self._steers and due <= self._received + self._patience + self._off else math.inf

    def rests(self, time: float) -> bool:
        """Return whether there is nothing to wait for: the gate does not steer, or the boards have been released."""
        return not self._steers or time > self._received + self._patience + self._off

    def says_off(self, time: float) -> bool:
        """Return whether an off frame is to be sent now."""
        if not time >= self.due:
            return False
        self._said = time
        return True


def main() -> int:
    """Guard until told to end, but not while the gate steers or its silence is being answered."""
    options = GateOptions.model_validate_json(sys.stdin.buffer.read())
    guard, shutdown, clock = Guard(options.safety.timing), ShutdownRequest(), options.clock
    folder, wires = Path(options.folder), dict[str, socket.socket]()
    receiver, endpoint = SocketReceiver(str(folder / BOARDS)), Endpoint(str(folder / GUARD))
    heartbeat = HeartbeatSender(Role.GUARD, endpoint, str(folder / GATE))
    for word in prepare(options.safety.timing.priority):
        say(f"guard: {word}")
    while not (shutdown.asked and guard.rests(clock())):
        clock.wait([endpoint.fileno(), receiver.fileno()], min(guard.due - clock(), _LOOK))
        now = clock()
        wires |= receiver.take()
        heartbeat.pass_time(clock.nanoseconds(), healthy=wires.keys() == options.boards.keys())
        for record in endpoint.receive():
            state = decode(record, GateState)
            if isinstance(state, GateState):
                guard.receive_state(now, state)
                heartbeat.state = state.state
        if guard.says_off(now):
            for body, wire in wires.items():
                _send(wire, options.boards[body].destination)
    endpoint.close()
    receiver.close()
    for wire in wires.values():
        wire.close()
    return 0


def _send(wire: socket.socket, board: tuple[str, int]) -> None:
    """Send an off frame; a network that is down keeps it from one board, not from the other."""
    try:
        wire.sendto(OFF, board)
    except OSError as error:
        say(f"guard: {board[0]} was not told to release the steering: {error}")


if __name__ == "__main__":
    sys.exit(run_program(main))
