"""Link: the console's end of the drive. It keeps what pages draw, and sends the sessions' requests."""

import itertools
import math
import time
from collections import deque
from collections.abc import Callable, Mapping

from drawbar.console.audit import Audit
from drawbar.console.device_rates import DeviceRates
from drawbar.console.drawing import Moving, moving
from drawbar.console.hand_log import HandLog
from drawbar.console.session import Session
from drawbar.console.signal_history import ShownStep
from drawbar.console.surveyor import Surveyor
from drawbar.console.visitors import MOST, Visitor
from drawbar.driving.messaging.datagrams import CorrectionsFailure, EstimateDeviations, PackedStep, unpack
from drawbar.driving.operator.requests import Operator
from drawbar.driving.preparation.push_calibration import STOPPED, PushCalibration
from drawbar.machine.hardware.bare_valve import Motion
from drawbar.messages import Action, ControllerState, Fixes, GateState, OperatorMessage
from drawbar.messages.records import decode
from drawbar.safety.engagement import STEERING
from drawbar.safety.operator_requests import ALWAYS
from drawbar.step.layout import unpacked
from drawbar.vehicle.parameters import VehicleParameters

STALE = 1_000_000_000
"""without a state of the gate for so long, what is shown is old, ns"""
_KEPT = 128
"""states of the gate that a browser may still acknowledge; 2.5 s"""
_LEFT = 10_000_000_000
"""whoever has drawn nothing for so long has left, and wishes for nothing, ns"""
_TRAIL = 3000
"""places of the tractor that are kept; 300 m"""
_TRAIL_STEP = 0.1
"""between two of them, m"""
_STEPS = 600
"""control steps that are kept to be looked at; two minutes at 5 Hz"""
_SUBSCRIBE = 500_000_000
"""between two attempts to subscribe to the gate's states, ns"""


class Link:
    """The console's view of the drive, and its sessions."""

    def __init__(
        self,
        send: Callable[[OperatorMessage], None],
        audit: Audit,
        clock: Callable[[], int],
        vehicle: VehicleParameters,
    ) -> None:
        """Take what hands a message to the gate, the audit log, the monotonic clock in ns, and the vehicle."""
        self._send, self._audit, self.clock, self.vehicle = send, audit, clock, vehicle
        self._nonces = itertools.count(time.monotonic_ns())  # larger than those of any other front end
        self._own = Operator(1, send, self._nonces)
        self._subscribe_due = self._stepped = 0
        self._states: deque[GateState] = deque(maxlen=_KEPT)
        self._sessions: dict[str, Session] = {}
        self.gate: GateState | None = None
        self.controller: ControllerState | None = None
        self.moving: Moving | None = None
        self._deviations: Mapping[str, float] = {}
        self.steps: deque[ShownStep] = deque(maxlen=_STEPS)
        """the newest control steps"""
        self._fixes: Fixes | None = None
        self._corrections, self._corrections_told = "", 0
        self.devices = DeviceRates()
        self.surveyor = Surveyor(vehicle.masts.tractor, vehicle.wheelbase, clock)
        self.hand_log = HandLog()
        self.pushing: PushCalibration | None = None
        """the bare valve is being pushed, by one page"""
        self._motion = Motion(-math.inf, math.nan, math.nan)
        self.trail: deque[tuple[float, float, float]] = deque(maxlen=_TRAIL)
        """x (m), y (m), lateral error (m) of the tractor"""
        self.wishes: dict[int, Visitor] = {}
        """who asks the holder for control, by session; whoever leaves wishes for nothing"""
        self.version = 0
        """grows with each control step received"""
        self.refused = 0
        """control steps that could not be read"""

    @property
    def is_stale(self) -> bool:
        """Whether nothing has come from the gate for too long."""
        return self.gate is None or self.clock() - self.gate.time > STALE

    @property
    def is_engaged(self) -> bool:
        """Whether the vehicle is steered, or stops; what is set up is not changed then."""
        return self.gate is not None and (bool(self.gate.steers) or self.gate.state in STEERING)

    @property
    def step_age(self) -> float:
        """Since the newest control step came, s."""
        return 1e-9 * (self.clock() - self._stepped)

    @property
    def speed(self) -> float:
        """Of the vehicle, m/s; NaN: not known."""
        if self.controller is None:
            return math.nan
        wheels = self.controller.wheel_speed
        return wheels if math.isfinite(wheels) else self.controller.receiver_speed

    @property
    def satellites(self) -> int:
        """In use by the receiver that has the fewest, of those that report how many; 0: not known."""
        fixes = self.fixes
        if fixes is None:
            return 0
        return min((each for each in (fixes.tractor.satellites, fixes.trailer.satellites) if each), default=0)

    @property
    def fixes(self) -> Fixes | None:
        """The newest of both receivers; None: there are no new ones."""
        fresh = self._fixes is not None and self.clock() - self._fixes.time <= STALE
        return self._fixes if fresh else None

    @property
    def corrections_failure(self) -> str:
        """Why no corrections come, and what to do; empty: they come, or no reason is known."""
        return self._corrections if self.clock() - self._corrections_told <= STALE else ""

    def motion(self) -> Motion:
        """Return how the tractor moves, by its receiver."""
        return self._motion

    def receive(self, data: bytes) -> None:
        """Take in a datagram."""
        datagram = unpack(data)
        if isinstance(datagram, PackedStep):
            self._receive_step(datagram)
            return
        if isinstance(datagram, EstimateDeviations):
            self._deviations = datagram.deviations
            return
        if isinstance(datagram, CorrectionsFailure):
            self._corrections, self._corrections_told = datagram.text, self.clock()
            return
        message = decode(data, GateState, ControllerState, Fixes)
        if isinstance(message, GateState):
            self._receive_gate(message)
        elif isinstance(message, ControllerState):
            self.controller = message
        if isinstance(message, GateState | ControllerState | Fixes):
            self.devices.receive(message, self.clock())
        if isinstance(message, Fixes):
            self._fixes = message
            self._motion = Motion(1e-9 * message.epoch, message.tractor.speed, message.tractor.yaw_rate)
            fresh = self.moving is not None and self.clock() - self._stepped <= STALE
            self.surveyor.receive_fixes(
                message,
                self.moving.tractor[2] if self.moving is not None and fresh else math.nan,
                self.gate.tractor_angle if self.gate is not None else math.nan,
            )

    def _receive_step(self, datagram: PackedStep) -> None:
        try:
            record = unpacked(datagram.data)
        except ValueError:
            self.refused += 1
            return
        self.moving = moving(record)
        self.steps.append(ShownStep(record, self.controller, self._deviations))
        self._deviations = {}
        self.hand_log.receive_step(record, engaged=self.is_engaged)
        self.version += 1
        self._stepped = self.clock()
        if self.moving is not None and self._has_moved(self.moving.tractor[:2]):
            self.trail.append((*self.moving.tractor[:2], record.reference.tractor.lateral_error))

    def _has_moved(self, place: tuple[float, float]) -> bool:
        return not self.trail or math.dist(place, self.trail[-1][:2]) > _TRAIL_STEP

    def _receive_gate(self, state: GateState) -> None:
        if self.gate is not None and state.lease != self.gate.lease:
            self.wishes.clear()
        self.gate = state
        self._states.append(state)
        self.hand_log.receive_gate(state)
        if self.pushing is not None and self.is_engaged:
            self.pushing.end("drawbar steers now; stop, then begin again")
        for session in self._sessions.values():
            session.receive_gate(state)

    def pass_time(self) -> None:
        """Ask the gate for its states where they do not come (nobody is present by that); forget whoever has left."""
        now = self.clock()
        self.wishes = {number: each for number, each in self.wishes.items() if each.may_drive and self._looks(each)}
        if self.is_stale and now >= self._subscribe_due:
            self._subscribe_due = now + _SUBSCRIBE
            self._own.ask(Action.PRESENT, now)

    def session(self, visitor: Visitor) -> Session:
        """Return a visitor's session; all pages of one browser share it. The least recently used ones are forgotten."""
        session = self._sessions.pop(visitor.token, None)
        if session is None:
            session = Session(visitor.number, visitor.name, self._send, self._nonces)
        self._sessions[visitor.token] = session
        if len(self._sessions) > MOST:
            del self._sessions[next(iter(self._sessions))]
        return session

    def drawn(self, visitor: Visitor, sequence: object) -> None:
        """Take a browser's word that it has drawn the state of this sequence; other words mean nothing."""
        state = next((each for each in reversed(self._states) if each.sequence == sequence), None)
        if state is None or isinstance(sequence, bool):
            return
        now = self.clock()
        quiet = any(session.awaits(now) for session in self._sessions.values())
        self.session(visitor).draw(state, now, attends=visitor.may_drive, quiet=quiet)

    def ask(self, visitor: Visitor, action: Action, value: float = 0.0) -> bool:
        """Ask the gate for something in a visitor's name; return whether it was sent. Everybody may stop."""
        allowed = visitor.may_drive or action in ALWAYS
        if action in ALWAYS and self.pushing is not None:
            self.pushing.end(STOPPED)
        sent = allowed and self.session(visitor).ask(action, self.clock(), value)
        self._audit.write(visitor, action.name, value=value, sent=sent)
        return sent

    def holder(self) -> str | None:
        """Return the name of whoever holds the lease: empty if it is not one of this console; None: nobody."""
        if self.gate is None or not self.gate.lease:
            return None
        names = (each.name for each in self._sessions.values() if each.number == self.gate.lease)
        return next(names, "")

    def _looks(self, visitor: Visitor) -> bool:
        session = self._sessions.get(visitor.token)
        return session is not None and session.seen is not None and self.clock() - session.seen.time <= _LEFT

    def wish(self, visitor: Visitor) -> None:
        """Ask the holder for control, for somebody who may have it."""
        if not visitor.may_drive:
            return
        self.wishes[visitor.number] = visitor
        self._audit.write(visitor, "ASK_FOR_CONTROL")
