"""Requests of an operator: a front end's side of the gate's socket, which keeps session, lease and what it has seen."""

import itertools
import math
from collections.abc import Callable, Iterator

from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.process_options import GATE, RECORDER, ProcessOptions
from drawbar.messages import Action, GateState, OperatorMessage, SupervisorState
from drawbar.messages.records import encode

_VALID = 500_000_000
"""for how long a message means something, ns"""


def gate_sender(endpoint: Endpoint, options: ProcessOptions) -> Callable[[OperatorMessage], None]:
    """Return what sends a front end's messages to the gate, and those that ask for something to the recorder too."""

    def send(message: OperatorMessage) -> None:
        record = encode(message)
        endpoint.send(options.socket(GATE), record)
        if message.action is not Action.PRESENT:
            endpoint.send_queued(options.socket(RECORDER), record)

    return send


class Operator:
    """Makes an operator's messages from the newest state of the gate that the operator sees."""

    def __init__(
        self, session: int, send: Callable[[OperatorMessage], None], nonces: Iterator[int] | None = None
    ) -> None:
        """Take a random number of this session, not 0, what hands a message to the gate, and nonces that only grow."""
        self._session, self._send = session, send
        self._nonces = nonces or itertools.count(1)
        self.seen: GateState | None = None
        """the newest state"""

    def see(self, state: GateState) -> None:
        """Take in a state of the gate, as it is shown to the operator."""
        self.seen = state

    def ask(self, action: Action, now: int, value: float = 0.0) -> int:
        """Ask the gate for something; return the nonce, with which a later state answers (`answered`, `answer`)."""
        nonce = next(self._nonces)
        self._send(
            OperatorMessage(
                sequence=nonce % 2**32,
                time=now,
                valid_until=now + _VALID,
                action=action,
                lease=self._session,
                nonce=nonce,
                seen_sequence=self.seen.sequence if self.seen else 0,
                seen_time=self.seen.time if self.seen else 0,
                value=value,
            )
        )
        return nonce


def changed_speed(state: GateState, change: float, configured: float) -> float:
    """Return the set speed to ask for, which differs by a change from the one that is wished; all in m/s.

    It stays between the size of the change and the configured speed: no plan is made for a higher one.
    """
    return min(max(wished_speed(state, configured) + change, abs(change)), configured)


def wished_speed(state: GateState, configured: float) -> float:
    """Return the speed that the operator wishes; without a wish the configured one is driven; all in m/s."""
    return state.set_speed if math.isfinite(state.set_speed) else configured


class DemonstrationOperator:
    """An operator for stand-ins: tries the emergency stop, engages as soon as that is possible, once, and stays."""

    def __init__(self, operator: Operator) -> None:
        """Take the operator's side of the socket."""
        self.operator = operator
        self._tried = self._engaged = False

    def see(self, state: GateState) -> None:
        """Take in a state of the gate."""
        self.operator.see(state)

    def look(self, now: int) -> None:
        """Do what is to be done now, ns; to be called a few times a second."""
        seen = self.operator.seen
        action = Action.PRESENT
        if seen is None:
            pass
        elif not self._tried and seen.state is SupervisorState.STANDBY:
            self._tried, action = True, Action.EMERGENCY
        elif seen.state is SupervisorState.ESTOP:
            action = Action.ACKNOWLEDGE
        elif seen.state is SupervisorState.READY and not self._engaged:
            action = Action.ENGAGE if seen.armed else Action.ARM
        elif seen.state in (SupervisorState.ENGAGING, SupervisorState.ACTIVE):
            self._engaged = True
        self.operator.ask(Action.PRESENT, now)
        if action is not Action.PRESENT:
            self.operator.ask(action, now)
