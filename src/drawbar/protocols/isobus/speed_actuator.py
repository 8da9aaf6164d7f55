"""Machine speed: a tractor that takes its speed over ISOBUS (0xFD43) and reports the one in use (0xF022)."""

import math
from collections import Counter

from drawbar.protocols.actuator import Readiness
from drawbar.protocols.isobus.guidance_messages import PASSING_EXITS, ExitReason, LimitStatus
from drawbar.protocols.isobus.identifier import Message
from drawbar.protocols.isobus.node import Component, IsobusNode
from drawbar.protocols.isobus.speed_command import SpeedCommand
from drawbar.protocols.isobus.tractor import Tractor
from drawbar.protocols.isobus.tractor_messages import SelectedSpeed
from drawbar.protocols.speed_actuator import SpeedActuator, SpeedReport, SpeedRequest
from drawbar.transports.base import CanFrame

_FACILITY = "selected speed"
_SETTLED = 1.0
"""the tractor must have sent for so long before it is engaged, and have sent an exit reason that is over, s"""
_CLEARED = 0.5
"""within which a tractor that drives must have cleared an exit reason from before, s"""


class MachineSpeed(SpeedActuator[CanFrame], Component):
    """The speed of one tractor under a node's address; the frames of the node come out of `send` too.

    Once it has driven, a request to stop is a ramp down to set point 0, which is held until the operator takes over at
    the tractor, as its selected speed says, or until it drives again. Before that, and after the operator has, no speed
    is asked for, and said to be none.

    A tractor may keep the exit reason of the last command that it left until it takes another one. As its selected
    speed tells no readiness, a reason that it has told for a second does not stand against driving; it must clear it
    once it drives.
    """

    def __init__(self, node: IsobusNode, limit: float) -> None:
        """Take the node and the largest amount of speed to ask for, m/s.

        Raises:
            ConfigurationError: the limit is no speed that the field can hold.
        """
        self.dropped: dict[str, int] = Counter()
        self._node, self._tractor, self._command = node, Tractor(), SpeedCommand(node, limit)
        self._set_point: float | None = None
        self._asked = -math.inf
        self._driving_since = self._received_since = self._reason_since = math.inf
        self._reason: int | None = None
        self._overridden = False
        node.attach(self)

    def receive(self, time: float, frame: CanFrame, source: str = "") -> None:
        """Take in one frame of the bus, for the node and for every component of it."""
        self._node.receive(time, frame, carrier=self)

    def receive_message(self, time: float, message: Message) -> None:
        """Take in what the tractor reports of its speed."""
        lost = self._tractor.reading(_FACILITY, time) is None
        self._tractor.receive_message(time, message)
        reading = self._tractor.reading(_FACILITY, time)
        if lost and reading is not None:
            self._received_since = time
        reason = reading.exit_reason if isinstance(reading, SelectedSpeed) else None
        if reason != self._reason or lost:
            self._reason, self._reason_since = reason, time
        if self._set_point is not None and self._state(time, reading) is Readiness.OVERRIDDEN:
            self._set_point, self._overridden = None, True

    def send(self, time: float, request: SpeedRequest) -> list[CanFrame]:
        """Return the node's frames and the command that is due."""
        elapsed, self._asked = time - self._asked, time
        if not request.drive:
            self._slow_down(request.deceleration * elapsed if math.isfinite(elapsed) else 0.0)
            self._overridden, self._driving_since = False, math.inf
        elif not self._overridden:
            self._set_point = request.speed
            self._driving_since = min(self._driving_since, time)
        return [*self._node.send(time), *self._command.send(time, self._set_point, stops=not request.drive)]

    def report(self, time: float) -> SpeedReport:
        """Return what is known now."""
        readiness = self._readiness(time)
        taken = self._tractor.speed(_FACILITY).time > self._driving_since
        return SpeedReport(
            engaged=taken and self._command.is_sent and readiness is Readiness.READY,
            overridden=self._overridden,
            readiness=readiness,
        )

    def _slow_down(self, step: float) -> None:
        if self._set_point is not None:
            self._set_point = math.copysign(max(abs(self._set_point) - step, 0.0), self._set_point)

    def _readiness(self, time: float) -> Readiness:
        reading = self._tractor.reading(_FACILITY, time)
        if not self._node.usable(time):
            return Readiness.ADDRESS_LOST
        if not isinstance(reading, SelectedSpeed):
            return Readiness.SILENT
        return Readiness.TOO_NEW if time - self._received_since < _SETTLED else self._state(time, reading)

    def _is_past(self, time: float, reason: int) -> bool:
        """Return whether an exit reason is that of an earlier end."""
        settled = time - self._reason_since >= _SETTLED
        return reason in PASSING_EXITS and settled and not time - self._driving_since > _CLEARED

    def _state(self, time: float, reading: object) -> Readiness:
        """Return whether a tractor takes commands, by its selected speed."""
        if not isinstance(reading, SelectedSpeed):
            return Readiness.SILENT
        reason = ExitReason.NONE if self._is_past(time, reading.exit_reason) else reading.exit_reason
        if reading.limit == LimitStatus.OPERATOR or reason == ExitReason.OPERATOR_OVERRIDE:
            return Readiness.OVERRIDDEN
        if reading.limit == LimitStatus.NON_RECOVERABLE:
            return Readiness.FAULT
        known = reason in (ExitReason.NONE, ExitReason.NOT_AVAILABLE) and math.isfinite(reading.speed)
        return Readiness.READY if known else Readiness.NOT_READY
