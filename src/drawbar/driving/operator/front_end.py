"""Front end: an operator's place at a terminal; also the one that drives demonstrations by itself."""

import os
import secrets
import select
import signal
import sys
import termios
import tty
from contextlib import suppress
from types import TracebackType
from typing import Self

from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.process_options import FRONT_END
from drawbar.driving.operator.requests import DemonstrationOperator, Operator, changed_speed, gate_sender
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.messages import Action, ControllerState, GateState, SupervisorState
from drawbar.messages.records import decode
from drawbar.safety.causes import BY_CODE, Cause

REFUSED = 15_000_000_000
"""for which a refusal is shown, ns"""
LOOK = 200_000_000
"""between two words of the operator, ns"""
_ACTIONS = {
    " ": Action.STOP,
    "r": Action.RELEASE,
    "x": Action.EMERGENCY,
    "a": Action.ACKNOWLEDGE,
}
_SPEED_STEP = 0.1
"""m/s"""
_MOST_KEYS = 64
"""bytes of keys that are taken at once"""


class Keyboard:
    """Single keys of a terminal, as a context; nothing where standard input is no terminal.

    `is_gone`: the terminal was closed, and nobody is there; its signal, SIGHUP, may be ignored.
    """

    def __enter__(self) -> Self:
        self._terminal, self.is_gone = sys.stdin.isatty(), False
        if self._terminal:
            self._before = termios.tcgetattr(sys.stdin)
            self._read_single_keys()
            self._continue = signal.signal(signal.SIGCONT, self._read_single_keys)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._terminal:
            signal.signal(signal.SIGCONT, self._continue)
            with suppress(termios.error):  # the terminal is gone
                termios.tcsetattr(sys.stdin, termios.TCSADRAIN, self._before)

    def _read_single_keys(self, *_: object) -> None:
        """Have the terminal hand over each key at once; a shell that stopped this process (Ctrl-Z) takes that back."""
        with suppress(termios.error):
            tty.setcbreak(sys.stdin)

    def pressed(self) -> str:
        """Return the keys that were pressed since the last call, in order; empty where there were none."""
        if not self._terminal or not select.select([sys.stdin], [], [], 0.0)[0]:
            return ""
        keys = b""
        with suppress(OSError):
            keys = os.read(sys.stdin.fileno(), _MOST_KEYS)  # a stream would keep others back
        self.is_gone |= not keys
        return keys.decode(errors="replace")


class FrontEnd:
    """The operator's side: receives the states of gate and controller, sends what the keys ask for."""

    def __init__(self, processes: DriveProcesses, *, demonstrates: bool) -> None:
        """Open its socket; demonstrates: engage by itself, as stand-ins want it."""
        self._endpoint = Endpoint(processes.options.socket(FRONT_END))
        self._operator = Operator(secrets.randbits(63) | 1, gate_sender(self._endpoint, processes.options))
        self._demonstration = DemonstrationOperator(self._operator) if demonstrates else None
        self._configured_speed, self._clock = processes.configuration.speed, processes.options.clock
        self._look = self._asked = self._refused = 0
        self.refusal: Cause | None = None
        """why the gate refused the newest key, for some seconds"""
        self.state: GateState | None = None
        self.controller: ControllerState | None = None
        self.drove = False
        """it has been engaged"""

    @property
    def is_over(self) -> bool:
        """Whether what was engaged has come to rest."""
        return (
            self.drove
            and self.state is not None
            and self.state.state
            in (
                SupervisorState.STOPPED,
                SupervisorState.OVERRIDE,
                SupervisorState.FAULT,
                SupervisorState.ESTOP,
            )
        )

    def wait(self, duration: float) -> None:
        """Receive for a time, s, and report that the operator is there."""
        self._clock.wait([self._endpoint], duration)
        for data in self._endpoint.receive():
            message = decode(data, GateState, ControllerState)
            if isinstance(message, GateState):
                self.state = message
                self._operator.see(message)
                self.drove |= message.state is SupervisorState.ACTIVE
                if self._asked and message.answered == self._asked:
                    self.refusal, self._asked = BY_CODE.get(message.answer), 0
                    self._refused = self._clock.nanoseconds()
            elif isinstance(message, ControllerState):
                self.controller = message
        now = self._clock.nanoseconds()
        if now - self._refused > REFUSED:
            self.refusal = None
        if now >= self._look:
            self._look = now + LOOK
            if self._demonstration is not None:
                self._demonstration.look(now)
            else:
                self._operator.ask(Action.PRESENT, now)

    def press(self, key: str) -> None:
        """Ask for what a key means; other keys mean nothing."""
        if key in _ACTIONS:
            self._ask(_ACTIONS[key])
        elif self.state is None:
            return
        elif key == "e":
            self._ask(Action.ENGAGE if self.state.armed else Action.ARM)
        elif key in ("+", "-"):
            change = _SPEED_STEP if key == "+" else -_SPEED_STEP
            self._ask(Action.SET_SPEED, changed_speed(self.state, change, self._configured_speed))

    def _ask(self, action: Action, value: float = 0.0) -> None:
        self._asked, self.refusal = self._operator.ask(action, self._clock.nanoseconds(), value), None

    def close(self) -> None:
        """Close the socket."""
        self._endpoint.close()
