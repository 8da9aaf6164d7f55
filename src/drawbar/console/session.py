"""Session: one browser that asks the gate for something. With each request it states which picture it has drawn.

A browser acknowledges each picture that it has drawn. Only these words make the operator present for the gate, so that
a browser that hangs, sleeps or is out of reach is not there, whatever its connection says. Pure: time is given.
"""

from collections.abc import Callable, Iterator

from drawbar.console.token_bucket import TokenBucket
from drawbar.driving.operator.requests import Operator
from drawbar.messages import Action, GateState, OperatorMessage
from drawbar.safety.causes import BY_CODE, Cause
from drawbar.safety.operator_requests import ALWAYS

PRESENT_PERIOD = 250_000_000
"""between two words to the gate that the operator is there, ns"""
OLD = 1_000_000_000
"""a picture older than this is no ground to ask for anything but a stop, ns"""
ANSWER = 1_000_000_000
"""within which the gate answers, ns"""
RATE, BURST = 5.0, 10.0
"""of commands, 1/s and at once"""


class Session:
    """What one browser has drawn, asked for and been answered."""

    def __init__(self, number: int, name: str, send: Callable[[OperatorMessage], None], nonces: Iterator[int]) -> None:
        """Take a random number, not 0, who it is, what hands a message to the gate, and nonces that only grow."""
        self.number, self.name = number, name
        self._operator = Operator(number, send, nonces)
        self._bucket = TokenBucket(RATE, BURST)
        self._present_due = 0
        self._asked: tuple[int, int, Action] | None = None  # nonce, time, action
        self.refusal: Cause | None = None
        """of what was asked for last; None: it was accepted, or no answer has come yet"""
        self.refusal_count = 0
        """how often a refusal was found, so that each is shown once"""

    @property
    def seen(self) -> GateState | None:
        """The newest state of the gate that the browser has drawn."""
        return self._operator.seen

    def draw(self, state: GateState, now: int, *, attends: bool, quiet: bool) -> None:
        """Take in that the browser has drawn a state.

        Args:
            state: that it has drawn.
            now: ns.
            attends: whoever looks may drive, and is present for the gate.
            quiet: an answer to somebody else is awaited, which another message would cover.
        """
        if self.seen is not None and state.time <= self.seen.time:
            return
        self._operator.see(state)
        if attends and not quiet and now >= self._present_due:
            self._present_due = now + PRESENT_PERIOD
            self._operator.ask(Action.PRESENT, now)

    def ask(self, action: Action, now: int, value: float = 0.0) -> bool:
        """Ask the gate for something; return whether the question was sent. Stops are always sent."""
        if action not in ALWAYS:
            if not self._bucket.take(now * 1e-9):
                return False
            if self.seen is None or now - self.seen.time > OLD:
                self._refuse(Cause.SEEN_OLD)
                return False
        self._asked = (self._operator.ask(action, now, value), now, action)
        return True

    def receive_gate(self, state: GateState) -> None:
        """Find the gate's answer in its newest state."""
        if self._asked is not None and state.answered == self._asked[0]:
            self._asked = None
            if state.answer:
                self._refuse(BY_CODE[state.answer])

    def awaits(self, now: int) -> bool:
        """Return whether an answer is still to come."""
        return self._asked is not None and now - self._asked[1] < ANSWER

    def unanswered(self, now: int) -> bool:
        """Return, once, that the gate has not answered in time."""
        if self._asked is None or now - self._asked[1] < ANSWER:
            return False
        self._asked = None
        return True

    def _refuse(self, cause: Cause) -> None:
        self.refusal = cause
        self.refusal_count += 1
