"""The console's end of a real drive, with a browser that draws at once and somebody at it."""

import select
import time

from drawbar.console.audit import Audit
from drawbar.console.link import Link
from drawbar.console.visitors import Rank, Visitor
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.process_options import CONSOLE, GATE
from drawbar.messages import Action, SupervisorState
from drawbar.messages.records import encode

LONGEST = 90.0
"""time until something happens on a busy machine, s"""


def in_state(*states):
    return lambda gate: gate.state in states


class Hand:
    """The console's end of a drive, with a browser that draws at once and somebody at it."""

    def __init__(self, processes, configuration):
        self._endpoint, gate = Endpoint(processes.options.socket(CONSOLE)), processes.options.socket(GATE)
        self.link = Link(
            lambda message: self._endpoint.send(gate, encode(message)),
            Audit(None),
            time.monotonic_ns,
            configuration.vehicle,
        )
        self._visitor = Visitor(token="one", number=1, name="one", rank=Rank.MAINTAINER)

    def until(self, condition, does=None):
        """Look and be present until a condition of the gate's state holds; ask for what `does` says each second."""
        end, again = time.monotonic() + LONGEST, 0.0
        while not (self.link.gate is not None and condition(self.link.gate)):
            assert time.monotonic() < end, self.link.gate
            select.select([self._endpoint], [], [], 0.05)
            for data in self._endpoint.receive():
                self.link.receive(data)
            self.link.pass_time()
            if self.link.gate is not None:
                self.link.drawn(self._visitor, self.link.gate.sequence)
            if does is not None and self.link.gate is not None and time.monotonic() > again:
                again = time.monotonic() + 1.0
                self.link.ask(self._visitor, *does(self.link.gate))

    def drives(self, offset):
        """Wait until the line so far to the left is driven, m."""
        self.until(lambda _: self.link.controller is not None and abs(self.link.controller.line_offset - offset) < 1e-9)

    def tries_emergency(self):
        """Try the emergency stop, as is asked for after each start."""
        self.until(in_state(SupervisorState.STANDBY))
        self.until(in_state(SupervisorState.ESTOP), lambda _: (Action.EMERGENCY,))
        self.until(in_state(SupervisorState.STANDBY, SupervisorState.READY), lambda _: (Action.ACKNOWLEDGE,))

    def engages(self):
        self.until(in_state(SupervisorState.READY))
        self.until(in_state(SupervisorState.ACTIVE), lambda gate: (Action.ENGAGE if gate.armed else Action.ARM,))

    def drive_on(self, duration):
        end = time.monotonic() + duration
        self.until(lambda _: time.monotonic() > end)

    def close(self):
        self._endpoint.close()
