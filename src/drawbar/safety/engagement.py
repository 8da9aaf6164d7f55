"""Engagement: the supervisor of a real machine, which decides whether the gate's process may steer (docs/safety.md).

A table of states and events, and the timers that make events of time. It lives in the gate's process and is pure: time
and all that is observed are given to it. It is not `run_monitor.h`, which ends one run of the control step when that
leaves its line; such an end is one of many causes here (CONTROLLER_STOPS).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto

from drawbar.messages import Action, SupervisorState
from drawbar.safety.causes import Cause, Response
from drawbar.safety.conditions import worst
from drawbar.safety.settings import SafetySettings

BOOT, SELFTEST, STANDBY, READY, ENGAGING, ACTIVE, DEGRADED, STOPPING, STOPPED, OVERRIDE, FAULT, ESTOP = SupervisorState
STEERING = frozenset({ENGAGING, ACTIVE, DEGRADED, STOPPING})
"""states in which the actuators are asked to steer; in all others they are commanded to release"""
LATCHED = frozenset({STOPPED, OVERRIDE, FAULT, ESTOP})
"""states that only the operator's acknowledgement ends"""
FATAL = frozenset({Cause.CONTROLLER_GONE, Cause.ENDED, Cause.DEVICE, Cause.SUSPENDED})
"""causes that are faults in every state"""


class Event(Enum):
    """What moves the supervisor; in one update they are applied in this order, so that the worst has the last word."""

    ACKNOWLEDGE = auto()
    """by the operator, where it is allowed"""
    BEGIN = auto()
    """the first update"""
    PASSED = auto()
    """the self-test: its time is over and nothing failed"""
    LOST = auto()
    """a condition of engaging"""
    MET = auto()
    """all conditions of engaging, for long enough"""
    ENGAGE = auto()
    """a new request by the operator"""
    TAKEN = auto()
    """all actuators and the controller have taken over, and the time of easing is over"""
    CALM = auto()
    """no cause to degrade for long enough"""
    DEGRADE = auto()
    """a cause to drive degraded"""
    STOP = auto()
    """by the operator, the controller or a cause"""
    STOOD = auto()
    """the vehicle stands, or the time for that is over"""
    RELEASE = auto()
    """by the operator"""
    OVERRIDE = auto()
    """the operator took over at an actuator"""
    FAULT = auto()
    """a cause to release at once"""
    EMERGENCY = auto()
    """stop of the operator"""


TABLE: dict[SupervisorState, dict[Event, SupervisorState]] = {
    BOOT: {Event.BEGIN: SELFTEST, Event.FAULT: FAULT},
    SELFTEST: {Event.PASSED: STANDBY, Event.FAULT: FAULT},
    STANDBY: {Event.MET: READY, Event.FAULT: FAULT},
    READY: {Event.LOST: STANDBY, Event.ENGAGE: ENGAGING, Event.RELEASE: STANDBY, Event.STOP: STANDBY}
    | {Event.FAULT: FAULT},
    ENGAGING: {Event.TAKEN: ACTIVE, Event.STOP: STOPPING, Event.RELEASE: STANDBY}
    | {Event.OVERRIDE: OVERRIDE, Event.FAULT: FAULT},
    ACTIVE: {Event.DEGRADE: DEGRADED, Event.STOP: STOPPING, Event.RELEASE: STANDBY}
    | {Event.OVERRIDE: OVERRIDE, Event.FAULT: FAULT},
    DEGRADED: {Event.CALM: ACTIVE, Event.STOP: STOPPING, Event.RELEASE: STANDBY}
    | {Event.OVERRIDE: OVERRIDE, Event.FAULT: FAULT},
    STOPPING: {Event.STOOD: STOPPED, Event.RELEASE: STOPPED, Event.OVERRIDE: OVERRIDE, Event.FAULT: FAULT},
    STOPPED: {Event.ACKNOWLEDGE: STANDBY, Event.FAULT: FAULT},
    OVERRIDE: {Event.ACKNOWLEDGE: STANDBY, Event.FAULT: FAULT},
    FAULT: {Event.ACKNOWLEDGE: SELFTEST},
    ESTOP: {Event.ACKNOWLEDGE: SELFTEST},
}
for _state in SupervisorState:
    TABLE[_state][Event.EMERGENCY] = ESTOP


def transition(state: SupervisorState, event: Event) -> SupervisorState:
    """Return the state after an event; one that means nothing in a state changes nothing."""
    return TABLE[state].get(event, state)


def _no_actuator(_: Cause | None) -> int:
    return 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    """What an update goes by."""

    causes: tuple[Cause, ...]
    """present now (conditions.py)"""
    actions: frozenset[Action] = frozenset()
    """of operators since the last update, those that were accepted"""
    overridden: bool = False
    """an actuator reports that the operator took over"""
    taken: bool = False
    """all actuators report that they steer, and the controller drives"""
    standing: bool = False
    """the vehicle stands for certain"""
    concerned: Callable[[Cause | None], int] = _no_actuator
    """which actuators report a cause, as bits of GateState.engaged"""


class Engagement:
    """The supervisor's state, since when and why."""

    def __init__(self, settings: SafetySettings, *, sound: bool = True) -> None:
        """Begin in BOOT; `sound`: whether the gate's own limits passed their test."""
        self._engage, self._drive, self._off = settings.engage, settings.drive, settings.timing.off
        self._sound = sound
        self.state = BOOT
        self.since = -math.inf
        """monotonic time of entering the state, s"""
        self.cause: Cause | None = None
        """what led to the state"""
        self.concerned = 0
        """which actuators reported it, as bits of GateState.engaged"""
        self.emergency_tried = False
        self._armed = -math.inf
        self._unmet = self._degraded = self._moved = -math.inf
        """when there last was a refusal, a cause to degrade, a motion, s"""

    @property
    def steers(self) -> bool:
        """Whether the actuators are to steer."""
        return self.state in STEERING

    def eases(self, time: float) -> bool:
        """Return whether the first second after engaging is not over."""
        return self.state is ENGAGING and time - self.since < self._drive.easing

    def armed(self, time: float) -> bool:
        """Return whether the operator may engage now."""
        return self.state is READY and time - self._armed <= self._engage.arming

    def arm(self, time: float) -> None:
        """Arm, in READY; leaving that state disarms."""
        self._armed = time

    def answer(self, time: float, action: Action) -> Cause | None:
        """Return why an operator's action is not possible in this state; None: it is."""
        if action in (Action.ARM, Action.ENGAGE, Action.LINE) and self.steers:
            return Cause.STEERED
        if action is Action.ARM and self.state is not READY:
            return Cause.STATE_NOT_READY
        if action is Action.ENGAGE and not self.armed(time):
            return Cause.NOT_ARMED if self.state is READY else Cause.STATE_NOT_READY
        if action is Action.ACKNOWLEDGE:
            if self.state not in LATCHED:
                return Cause.NOTHING_TO_ACKNOWLEDGE
            if self.state is not OVERRIDE and not self._stands(time):
                return Cause.NOT_STANDING
        return None

    def remaining(self, time: float) -> float:
        """Return the time until this state may end by itself, s; NaN: it does not."""
        stopping, abandoning = self._drive.stopping, self._drive.abandoning
        limits = {
            SELFTEST: self._off,
            ENGAGING: self._drive.engaging,
            DEGRADED: self._drive.budget,
            STOPPING: stopping if time - self.since <= stopping else abandoning,
        }
        return max(self.since + limits[self.state] - time, 0.0) if self.state in limits else math.nan

    def hurries(self, time: float) -> bool:
        """Return whether to stop as fast as possible: in an emergency, unsteered, or where a stop takes too long."""
        unsteered = self.state in (ESTOP, FAULT) or self.cause is Cause.STOP_IGNORED
        return unsteered or (self.state is STOPPING and time - self.since >= self._drive.comfort)

    def update(self, time: float, situation: Situation) -> SupervisorState:
        """Take in what is so at a time, s, which never decreases; return the state from now on."""
        self._remember(time, situation)
        events, before = self._events(time, situation), self.state
        for event in Event:
            if event in events:
                self._enter(transition(self.state, event), time, events[event])
        if self.state is not before:
            self.concerned = situation.concerned(self.cause)
        self.emergency_tried |= Action.EMERGENCY in situation.actions
        return self.state

    def _remember(self, time: float, situation: Situation) -> None:
        if any(cause.refuses for cause in situation.causes):
            self._unmet = time
        if worst(situation.causes)[0] >= Response.DEGRADE:
            self._degraded = time
        if not situation.standing:
            self._moved = time

    def _stands(self, time: float) -> bool:
        return time - self._moved >= self._drive.stood

    def _enter(self, state: SupervisorState, time: float, cause: Cause | None) -> None:
        if state is self.state:
            return
        self.state, self.since, self.cause, self._armed = state, time, cause, -math.inf

    def _events(self, time: float, situation: Situation) -> dict[Event, Cause | None]:
        events: dict[Event, Cause | None] = dict(_asked(situation.actions))
        if self.state is not READY:  # no operator has seen a state that becomes READY in this very update
            events.pop(Event.ENGAGE, None)
        if Action.ACKNOWLEDGE in situation.actions and self.answer(time, Action.ACKNOWLEDGE) is None:
            events[Event.ACKNOWLEDGE] = None
        fatal = next((cause for cause in situation.causes if cause in FATAL), None)
        if fatal is not None:
            events[Event.FAULT] = fatal
        if self.state in STEERING:
            events |= self._while_steering(time, situation)
        else:
            events |= self._at_rest(time)
        return events

    def _at_rest(self, time: float) -> dict[Event, Cause | None]:
        events: dict[Event, Cause | None] = {}
        if self.state is BOOT:
            events[Event.BEGIN] = None
        elif self.state is SELFTEST and not self._sound:
            events[Event.FAULT] = Cause.SELFTEST
        elif self.state is SELFTEST and time - self.since >= self._off:
            events[Event.PASSED] = None
        elif self.state is STANDBY and time - max(self._unmet, self.since) >= self._engage.hold:
            events[Event.MET] = None
        elif self.state is READY and self._unmet == time:
            events[Event.LOST] = None
        return events

    def _patience(self, response: Response) -> float:
        """Return for how long a vehicle that does not stop is steered on, s: releasing it makes nothing better."""
        return self._drive.stopping if response >= Response.STOP else self._drive.abandoning

    def _while_steering(self, time: float, situation: Situation) -> dict[Event, Cause | None]:
        events: dict[Event, Cause | None] = {}
        response, cause = worst(situation.causes)
        if response in _RESPONSES:
            events[_RESPONSES[response]] = cause
        if situation.overridden:
            events[Event.OVERRIDE] = Cause.OPERATOR_STEERS
        if self.state is ENGAGING:
            return events | self._while_engaging(time - self.since, taken=situation.taken)
        if self.state is DEGRADED:
            return self._while_degraded(time) | events  # a stop that has a cause of its own is not the budget's
        if self.state is STOPPING:
            return events | self._while_stopping(time, response)
        return events

    def _while_engaging(self, spent: float, *, taken: bool) -> dict[Event, Cause | None]:
        if taken and spent >= self._drive.easing:
            return {Event.TAKEN: None}
        return {Event.FAULT: Cause.NOT_TAKEN} if spent >= self._drive.engaging else {}

    def _while_degraded(self, time: float) -> dict[Event, Cause | None]:
        if time - self._degraded >= self._drive.recovery:
            return {Event.CALM: None}
        return {Event.STOP: Cause.BUDGET} if time - self.since >= self._drive.budget else {}

    def _while_stopping(self, time: float, response: Response) -> dict[Event, Cause | None]:
        if self._stands(time):
            return {Event.STOOD: self.cause}
        return {Event.STOOD: Cause.STOP_IGNORED} if time - self.since >= self._patience(response) else {}


_RESPONSES = {Response.DEGRADE: Event.DEGRADE, Response.STOP: Event.STOP, Response.RELEASE: Event.FAULT}
_ASKED: dict[Action, tuple[Event, Cause | None]] = {
    Action.ENGAGE: (Event.ENGAGE, None),
    Action.RELEASE: (Event.RELEASE, Cause.OPERATOR_RELEASES),
    Action.STOP: (Event.STOP, Cause.OPERATOR_STOPS),
    Action.EMERGENCY: (Event.EMERGENCY, Cause.EMERGENCY),
}


def _asked(actions: frozenset[Action]) -> list[tuple[Event, Cause | None]]:
    return [_ASKED[action] for action in sorted(actions) if action in _ASKED]
