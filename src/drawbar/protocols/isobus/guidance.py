"""Guidance valve: one steering valve commanded by curvature over ISOBUS (ISO 11783-7, 0xAD00 and 0xAC00)."""

import math
from collections import Counter
from enum import Enum, auto

from drawbar.protocols.actuator import Readiness, SteeringActuator, SteeringReport, SteeringRequest
from drawbar.protocols.isobus.address import CLAIM
from drawbar.protocols.isobus.cadence import Cadence
from drawbar.protocols.isobus.curvature import CurvatureMap
from drawbar.protocols.isobus.guidance_messages import (
    MACHINE_INFO,
    PASSING_EXITS,
    SYSTEM_COMMAND,
    ExitReason,
    Intention,
    LimitStatus,
    MachineInfo,
    SystemCommand,
    decode_command,
    decode_machine_info,
    encodable,
    encode_command,
)
from drawbar.protocols.isobus.identifier import GLOBAL, Message
from drawbar.protocols.isobus.node import Component, IsobusNode
from drawbar.protocols.swings import Swings
from drawbar.transports.base import CanFrame

_GAP = 0.3
"""silence of the valve after which it is not there, s"""
_SETTLED = 1.0
"""the valve must have sent for so long before it is engaged, s"""
_CLEARED = 0.5
"""within which a valve that steers must have cleared an exit reason from before, s"""
_OTHER_MASTER_HOLD = 1.0
"""for how long another sender of commands is remembered, s"""
_SWINGS = 3
"""of the angle, one after the other, that show two valves at one address"""
_OFF_TIME = 1.0
"""for which "not intended" is sent after steering, also where another sender commands, s"""
_OPERATOR_EXITS = (ExitReason.OPERATOR_OVERRIDE,)
_FAULT_EXITS = (ExitReason.CONTROL_FAULT, ExitReason.FUNCTION_FAULT, ExitReason.ERROR)
_NO_EXITS = (ExitReason.NONE, ExitReason.NOT_AVAILABLE)
_LIMITS_WHILE_STEERING = (LimitStatus.NOT_LIMITED, LimitStatus.LIMITED_HIGH, LimitStatus.LIMITED_LOW)
"""a valve at its stop still steers as asked as far as it can"""


class _Phase(Enum):
    LATCHED = auto()
    """does not steer, and must be released before it may"""
    RELEASED = auto()
    """has been released on the wire; the next request to steer is an edge"""
    STEERING = auto()


class GuidanceValve(SteeringActuator[CanFrame], Component):
    """One valve under a node's address; the frames of the node come out of `send` too.

    "Intended to steer" goes out only at a request that follows a message "not intended" sent without one, and only
    while every condition holds. Whatever ends it - the request, the valve, silence, the operator, the loss of the
    address - is followed at once by "not intended", and by that alone until the gate has released. Commands go every
    `period`, s, whatever the rate of `send`, a new angle up to a fifth of it earlier; only that first "not intended"
    comes out of turn. While another sender intends to steer the valve nothing is commanded, but for the second after
    drawbar has steered.

    An exit reason is why a valve takes no commands, or why it has last ceased to. Where a valve keeps it although it
    says that it is ready, it is the latter after a second, and does not stand against steering; the valve must clear
    it once it steers.

    `address` is the valve's own; None: it is the only one on the bus, and is commanded by messages to all. Where a
    stronger NAME claims it the valve must leave it, and what is sent from there counts as from a valve that was silent.
    """

    def __init__(
        self, node: IsobusNode, curvature: CurvatureMap, *, address: int | None = None, period: float = 0.1
    ) -> None:
        self.dropped: dict[str, int] = Counter()
        self.machine: MachineInfo | None = None
        """what the valve has sent last, its engage switch included"""
        self.contested = False
        """devices of two NAMEs have claimed the valve's address"""
        self.swings = Swings()
        """of its angle"""
        self._node, self._map, self._address = node, curvature, address
        self._cadence = Cadence(period)
        self._phase = _Phase.LATCHED
        self._last_sent = math.nan
        """the angle that was commanded last, rad"""
        self._cause: Readiness | None = None
        """what the latch was set by, until it is released"""
        self._overridden = False
        self._stop_now = False
        """"not intended" is to be sent out of turn"""
        self._source: int | None = address
        self._name: int | None = None
        """the strongest NAME that has claimed the valve's address: whoever has another one must leave it"""
        self._info_time = self._second_valve_time = self._other_master_time = self._steered = -math.inf
        self._received_since = self._steering_since = self._reason_since = math.inf
        self._losses = node.claim.losses
        node.attach(self)

    def receive(self, time: float, frame: CanFrame, source: str = "") -> None:
        """Take in one frame of the bus, for the node and for every component of it."""
        self._node.receive(time, frame, carrier=self)

    def receive_message(self, time: float, message: Message) -> None:
        """Take in the valve's own state, who else commands it, and who claims its address."""
        if message.pgn == MACHINE_INFO:
            self._receive_info(time, message)
        elif message.pgn == CLAIM and message.source == self._source and len(message.data) == 8:
            self._receive_claim(int.from_bytes(message.data, "little"))
        elif message.pgn == SYSTEM_COMMAND and message.destination in (GLOBAL, self._source):
            command = decode_command(message.data)
            if command is None:
                self.dropped["length"] += 1
            elif command.intention is Intention.INTENDED:
                self._other_master_time = time
                self.dropped["other master"] += 1

    def send(self, time: float, request: SteeringRequest) -> list[CanFrame]:
        """Return the node's frames and the command that is due."""
        frames = self._node.send(time)
        self._follow(time, request)
        if not self._node.claim.held:
            return frames
        if self._yields(time):
            return frames
        if self._stop_now:
            self._cadence.restart(time)
        elif not self._cadence.due(time, news=self._phase is _Phase.STEERING and request.angle != self._last_sent):
            return frames
        return [*frames, self._command(time, request)]

    def report(self, time: float) -> SteeringReport:
        """Return what is known now."""
        info, conditions = self.machine, self._conditions(time)
        steering = self._phase is _Phase.STEERING and self._info_time > self._steering_since
        return SteeringReport(
            angle=self._map.angle(info.curvature) if info is not None else math.nan,
            angle_time=self._info_time,
            engaged=steering and conditions is Readiness.READY,
            overridden=self._overridden,
            readiness=self._cause or conditions,
        )

    def _receive_claim(self, name: int) -> None:
        """Notice another device at the valve's address: where it is the stronger, that is no longer the valve's."""
        if self._name is not None and name != self._name:
            self.contested = True
            if name < self._name:
                self._info_time = -math.inf
                if self._phase is _Phase.STEERING:
                    self._leave(Readiness.FAULT)
        self._name = name if self._name is None else min(name, self._name)

    def _receive_info(self, time: float, message: Message) -> None:
        if self._address is None and time - self._info_time > _GAP and message.source != self._source:
            self._source, self._name = message.source, None
        if message.source != self._source:
            if self._address is None:
                self.dropped["second valve"] += 1
                self._second_valve_time = time
            return
        info = decode_machine_info(message.data)
        if info is None:
            self.dropped["length"] += 1
            return
        if self.machine is None or info.exit_reason != self.machine.exit_reason:
            self._reason_since = time
        if time - self._info_time > _GAP:
            self._received_since = time
            self.swings.forget()
            if self._phase is _Phase.STEERING:
                self._leave(Readiness.SILENT)
        self.swings.see(self._map.angle(info.curvature))
        if self.swings.in_a_row >= _SWINGS:
            self._second_valve_time = time
        self.machine, self._info_time = info, time
        # A state that lasts for one message only is seen here, whatever the gate's rate.
        state = self._state(time, info)
        if self._phase is _Phase.STEERING and state is not Readiness.READY:
            self._leave(state)

    def _follow(self, time: float, request: SteeringRequest) -> None:
        """Change the phase by the request and the conditions."""
        if self._losses != self._node.claim.losses:
            # From a new address "not intended" has not been sent yet.
            self._losses = self._node.claim.losses
            self._leave(Readiness.ADDRESS_LOST)
        elif not request.steer:
            if self._phase is _Phase.STEERING:
                self._leave(None)
        elif self._phase is _Phase.LATCHED:
            self._cause = self._cause or Readiness.SWITCHED_ON
        elif not self._sayable(request.angle):
            self.dropped["command out of range"] += 1
            self._leave(Readiness.FAULT)
        elif (conditions := self._conditions(time)) is not Readiness.READY:
            self._leave(conditions)

    def _yields(self, time: float) -> bool:
        """Return whether somebody else steers the valve, whom "not intended" would disturb; it was sent for a while."""
        released = self._phase is not _Phase.STEERING and time - self._steered >= _OFF_TIME
        return released and time - self._other_master_time <= _OTHER_MASTER_HOLD

    def _sayable(self, angle: float) -> bool:
        return math.isfinite(angle) and encodable(self._map.curvature(angle))

    def _leave(self, cause: Readiness | None) -> None:
        """Do not steer until released; None: the gate releases by itself."""
        self._stop_now = self._stop_now or self._phase is _Phase.STEERING
        self._phase = _Phase.LATCHED
        self._cause = self._cause or cause
        self._overridden = self._overridden or cause is Readiness.OVERRIDDEN

    def _command(self, time: float, request: SteeringRequest) -> CanFrame:
        """Return the command, and count it as gone."""
        self._stop_now = False
        if not request.steer:
            self._phase, self._cause, self._overridden = _Phase.RELEASED, None, False
        elif self._phase is _Phase.RELEASED:
            self._phase, self._steering_since = _Phase.STEERING, time
        self._last_sent = request.angle
        self._steered = time if self._phase is _Phase.STEERING else self._steered
        if self._phase is _Phase.STEERING:
            command = SystemCommand(curvature=self._map.curvature(request.angle), intention=Intention.INTENDED)
        else:
            command = SystemCommand(curvature=0.0, intention=Intention.NOT_INTENDED)
        destination = GLOBAL if self._address is None else self._address
        return self._node.frame(SYSTEM_COMMAND, encode_command(command), destination)

    def _conditions(self, time: float) -> Readiness:
        """Return whether the valve may steer now, or the first condition that fails."""
        if not self._node.usable(time):
            return Readiness.ADDRESS_LOST
        if self.machine is None or not (time - self._info_time <= _GAP):
            return Readiness.SILENT
        if not (time - self._received_since >= _SETTLED):
            return Readiness.TOO_NEW
        if time - self._other_master_time <= _OTHER_MASTER_HOLD:
            return Readiness.OTHER_MASTER
        if time - self._second_valve_time <= _GAP:
            return Readiness.FAULT
        return self._state(time, self.machine)

    def _is_past(self, time: float, reason: int) -> bool:
        """Return whether an exit reason of a valve that is ready is that of an earlier end."""
        cleared_by = self._steering_since + _CLEARED if self._phase is _Phase.STEERING else math.inf
        settled = time - max(self._reason_since, self._received_since) >= _SETTLED
        return reason in PASSING_EXITS and settled and time <= cleared_by

    def _state(self, time: float, info: MachineInfo) -> Readiness:
        """Return what the valve's own states allow; what it does not report is no."""
        limits = _LIMITS_WHILE_STEERING if self._phase is _Phase.STEERING else (LimitStatus.NOT_LIMITED,)
        ready = (info.locked_out, info.ready, info.in_position, info.reset_required) == (False, True, True, False)
        reason = ExitReason.NONE if ready and self._is_past(time, info.exit_reason) else info.exit_reason
        if info.limit == LimitStatus.OPERATOR or reason in _OPERATOR_EXITS:
            return Readiness.OVERRIDDEN
        if info.locked_out:
            return Readiness.LOCKED_OUT
        if info.limit == LimitStatus.NON_RECOVERABLE or reason in _FAULT_EXITS:
            return Readiness.FAULT
        if reason == ExitReason.OTHER_GUIDANCE:
            return Readiness.OTHER_MASTER
        expected = ready and reason in _NO_EXITS and info.limit in limits
        return Readiness.READY if expected and math.isfinite(info.curvature) else Readiness.NOT_READY
