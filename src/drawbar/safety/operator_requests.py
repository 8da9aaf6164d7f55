"""Operator requests: what is asked for, by message or by a switch at an actuator, and what becomes of it. Pure.

One operator at a time holds the lease and may engage; stopping needs no lease. A message counts if it has not been
received before, is not old, and its sender sees what the gate does now.
"""

import math
from collections import deque

from drawbar.messages import Action, OperatorMessage
from drawbar.nanoseconds import seconds
from drawbar.safety.causes import Cause
from drawbar.safety.engagement import Engagement
from drawbar.safety.envelope import AHEAD
from drawbar.safety.settings import SafetySettings

SESSIONS = 16
"""sessions whose nonces are remembered; the one that was silent for longest is forgotten first"""
ALWAYS = frozenset({Action.RELEASE, Action.STOP, Action.EMERGENCY})
"""accepted from everybody, whatever they see"""
_TAKE_LEASE = frozenset({Action.ARM, Action.ACKNOWLEDGE, Action.LINE})
_LINES = 10_000
"""most working widths from the configured line"""


class OperatorRequests:
    """Who holds the lease, what was asked for since the last tick, and the answer to the last message."""

    def __init__(self, settings: SafetySettings, engagement: Engagement) -> None:
        """Begin without an operator."""
        self._settings, self._engagement = settings, engagement
        self._nonces: dict[int, int] = {}
        self._shown: deque[tuple[int, int]] = deque(maxlen=64)
        self._received = self._holder_received = -math.inf
        self._actions: set[Action] = set()
        self._switched: dict[int, bool] = {}
        self._by_switch = False  # it was a switch that asked last to engage
        self.lease = 0
        self.answer: Cause | None = None
        self.answered = 0
        self.nudge = 0.0
        """m, to the left of the configured line's direction"""
        self.set_speed = math.nan
        """m/s"""
        self.line = 0
        """working widths to the left of the configured line"""

    def show(self, sequence: int, time: int) -> None:
        """Remember a state of the gate that operators can see from now on; time in ns."""
        self._shown.append((sequence, time))

    def receive(self, time: float, message: OperatorMessage) -> None:
        """Take in a message at a time, s; what is accepted is taken by `take`."""
        refusal = self._refusal(time, message)
        if refusal is not None or message.action is not Action.PRESENT:  # that may come right after what is refused
            self.answer, self.answered = refusal, message.nonce
        if refusal is None:
            self._accept(time, message)

    def switch(self, actuator: int, on: bool | None) -> None:
        """Take in an actuator's switch; only a change that was seen asks for something."""
        if on is None:
            self._switched.pop(actuator, None)
            return
        before = self._switched.get(actuator, on)
        self._switched[actuator] = on
        if on != before:
            self._by_switch |= on
            self._actions.add(Action.ENGAGE if on else Action.RELEASE)

    def take(self) -> frozenset[Action]:
        """Return what was asked for since the last call."""
        actions = frozenset(self._actions)
        self._actions.clear()
        return actions

    def age(self, time: float) -> float:
        """Return the time since the responsible operator's last message, s.

        While driving that is who engaged, before that any; a switch that is read is always present.
        """
        if self._engagement.steers and not self._by_switch:
            return time - self._holder_received
        return 0.0 if self._switched else time - self._received

    def _refusal(self, time: float, message: OperatorMessage) -> Cause | None:
        action = message.action
        if action in ALWAYS:
            return None
        fresh = (
            seconds(message.time) - AHEAD
            <= time
            <= min(seconds(message.valid_until), seconds(message.time) + self._settings.engage.seen)
        )
        if not message.lease or message.nonce <= self._nonces.get(message.lease, 0) or not fresh:
            return Cause.REPLAYED
        self._remember(message)
        shown = (message.seen_sequence, message.seen_time) in self._shown
        if not (shown and time - seconds(message.seen_time) <= self._settings.engage.seen):
            return Cause.SEEN_OLD
        if action is Action.PRESENT:
            return None
        return (
            self._lease_refusal(time, message) or self._value_refusal(message) or self._engagement.answer(time, action)
        )

    def _remember(self, message: OperatorMessage) -> None:
        self._nonces.pop(message.lease, None)
        self._nonces[message.lease] = message.nonce
        if len(self._nonces) > SESSIONS:
            del self._nonces[next(iter(self._nonces))]

    def _lease_refusal(self, time: float, message: OperatorMessage) -> Cause | None:
        if message.lease == self.lease:
            return None
        if self.lease and time - self._holder_received <= self._settings.timing.lease:
            return Cause.LEASE_HELD
        return None if message.action in _TAKE_LEASE else Cause.NOT_ARMED

    def _value_refusal(self, message: OperatorMessage) -> Cause | None:
        allowed = True
        if message.action is Action.NUDGE:
            allowed = abs(self.nudge + message.value) <= self._settings.nudge
        elif message.action is Action.LINE:
            allowed = abs(message.value) <= _LINES and message.value == int(message.value)
        elif message.action is Action.SET_SPEED:
            allowed = 0.0 < message.value <= self._settings.envelope.speed
        return None if allowed else Cause.OUT_OF_RANGE

    def _accept(self, time: float, message: OperatorMessage) -> None:
        action = message.action
        self._received = time
        if action in _TAKE_LEASE:
            self.lease = message.lease
        if message.lease == self.lease:
            self._holder_received = time
        if action is Action.ARM:
            self._engagement.arm(time)
        elif action is Action.NUDGE:
            self.nudge += message.value
        elif action is Action.SET_SPEED:
            self.set_speed = message.value
        elif action is Action.LINE:
            self.line = int(message.value)
        elif action is not Action.PRESENT:
            self._actions.add(action)
            self._by_switch &= action is not Action.ENGAGE
        if action is Action.RELEASE and message.lease == self.lease:
            self.lease = 0
