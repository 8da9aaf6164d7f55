"""Stand-in valve: an ISOBUS steering valve's control unit, which checks the sender of its commands."""

import math
from collections import Counter, deque

from drawbar.protocols.isobus.cadence import Cadence
from drawbar.protocols.isobus.guidance_messages import (
    MACHINE_INFO,
    SYSTEM_COMMAND,
    ExitReason,
    Intention,
    LimitStatus,
    MachineInfo,
    SystemCommand,
    decode_command,
    encode_machine_info,
)
from drawbar.protocols.isobus.identifier import GLOBAL, Message
from drawbar.protocols.isobus.node import Component, IsobusNode
from drawbar.transports.base import CanFrame

_PERIOD = 0.1
_TIMEOUT = 0.15
"""without a command, s"""
_REACH = 0.6
"""largest curvature, 1/m"""
_EXITS = 100


class StandInValve(Component):
    """A valve that steers while it is allowed and commanded within its time-out; times are monotonic, s.

    It engages at "intended to steer" from a sender that has sent "not intended" since the last release, and reports
    why it releases. What a test or a simulated machine sets: the attributes below. `rate` is how fast it turns,
    (1/m)/s; None: another moves `curvature` after `target`.
    """

    def __init__(self, node: IsobusNode, *, rate: float | None = 0.5) -> None:
        self.dropped: Counter[str] = Counter()
        self.curvature = 0.0
        """what the machine's wheels do, 1/m, left positive"""
        self.speed = 0.0
        """of the machine, m/s"""
        self.slowest, self.fastest = 0.0, math.inf
        """amounts of speed between which it steers, m/s"""
        self.locked_out = False
        """the operator's lockout switch"""
        self.operator_steers = False
        """the operator turns the wheel"""
        self.engage_switch: bool | None = False
        """the operator's switch that asks for steering"""
        self.interlock = ExitReason.NONE
        """any other reason for which it is not ready"""
        self.silent = False
        """its information is lost on the way"""
        self.exits: deque[tuple[float, ExitReason]] = deque(maxlen=_EXITS)
        """when and why it released by itself, the last ones"""
        self._node, self._rate = node, rate
        self._cadence = Cadence(_PERIOD)
        self._master: int | None = None
        """the sender that may engage it, or steers"""
        self._target: float | None = None
        self.last_received = -math.inf
        """when it was commanded last, even if only not to steer, s"""
        self._exit_reason = ExitReason.NONE
        self._command_time = self._moved = -math.inf
        node.attach(self)

    @property
    def engaged(self) -> bool:
        """Whether it steers."""
        return self._target is not None

    @property
    def target(self) -> float | None:
        """Where it steers to, 1/m, left positive, within its reach; None: it does not."""
        return None if self._target is None else max(-_REACH, min(_REACH, self._target))

    def receive_message(self, time: float, message: Message) -> None:
        """Take in a command."""
        if message.pgn != SYSTEM_COMMAND or message.destination not in (GLOBAL, self._node.claim.address):
            return
        command = decode_command(message.data)
        if command is None:
            self.dropped["length"] += 1
            return
        self.last_received = time
        if self.engaged:
            self._follow(time, message.source, command)
        elif command.intention is Intention.NOT_INTENDED:
            self._master, self._exit_reason = message.source, ExitReason.NONE
        elif command.intention is Intention.INTENDED and message.source == self._master:
            self._engage(time, command)

    def frames(self, time: float) -> list[CanFrame]:
        """Move, and return the information that is due."""
        self._move(time)
        if self.silent or not self._node.claim.held or not self._cadence.due(time):
            return []
        return [self._node.frame(MACHINE_INFO, encode_machine_info(self.info()))]

    def info(self) -> MachineInfo:
        """Return its own state."""
        obstacle = self._obstacle()
        return MachineInfo(
            curvature=self.curvature,
            locked_out=self.locked_out,
            ready=obstacle is ExitReason.NONE,
            in_position=not self.operator_steers,
            reset_required=self._master is None and self._exit_reason is not ExitReason.NONE,
            limit=self._limit(),
            exit_reason=self._exit_reason,
            engage_switch=self.engage_switch,
        )

    def _engage(self, time: float, command: SystemCommand) -> None:
        obstacle = self._obstacle()
        if obstacle is ExitReason.NONE:
            self._target, self._command_time = 0.0, time
            self._follow(time, self._master, command)
        else:
            self._leave(time, obstacle)

    def _follow(self, time: float, source: int | None, command: SystemCommand) -> None:
        """Take a command while steering."""
        if source != self._master:
            if command.intention is Intention.INTENDED:
                self._leave(time, ExitReason.OTHER_GUIDANCE)
        elif command.intention is Intention.NOT_INTENDED:
            self._target = None
        elif command.intention is Intention.INTENDED and math.isfinite(command.curvature):
            self._target, self._command_time = command.curvature, time
        else:
            self._leave(time, ExitReason.OUT_OF_RANGE)

    def _leave(self, time: float, reason: ExitReason) -> None:
        """Release the steering; only "not intended" allows to engage again."""
        self._target = self._master = None
        self._exit_reason = reason
        self.exits.append((time, reason))

    def _move(self, time: float) -> None:
        elapsed, self._moved = time - self._moved, time
        if not self.engaged:
            return
        if time - self._command_time > _TIMEOUT:
            self._leave(time, ExitReason.COMMAND_TIMEOUT)
        elif (obstacle := self._obstacle()) is not ExitReason.NONE:
            self._leave(time, obstacle)
        elif self._rate is not None and self.target is not None and math.isfinite(elapsed):
            step = self._rate * elapsed
            self.curvature += max(-step, min(step, self.target - self.curvature))

    def _obstacle(self) -> ExitReason:
        """Return why it may not steer."""
        if self.operator_steers:
            return ExitReason.OPERATOR_OVERRIDE
        if self.locked_out:
            return ExitReason.CONTROL_NOT_IN_POSITION
        if abs(self.speed) < self.slowest:
            return ExitReason.TOO_SLOW
        if abs(self.speed) > self.fastest:
            return ExitReason.TOO_FAST
        return self.interlock

    def _limit(self) -> LimitStatus:
        if self.operator_steers:
            return LimitStatus.OPERATOR
        if self.interlock is ExitReason.FUNCTION_FAULT:
            return LimitStatus.NON_RECOVERABLE
        if self._target is None or abs(self._target) <= _REACH:
            return LimitStatus.NOT_LIMITED
        # Right is positive on the wire.
        return LimitStatus.LIMITED_LOW if self._target > 0.0 else LimitStatus.LIMITED_HIGH
