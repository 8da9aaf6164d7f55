"""Heartbeat: the counter by which others see that a device is alive, sent once somebody has asked for it (0xF0E4)."""

import math
from collections import Counter

from drawbar.protocols.isobus.cadence import Cadence
from drawbar.protocols.isobus.identifier import GLOBAL, Message
from drawbar.protocols.isobus.node import Component, IsobusNode
from drawbar.transports.base import CanFrame

HEARTBEAT = 0xF0E4
REPETITION_RATE = 0xCC00
"""request for a group to be repeated: its number in three bytes, the period in ms in two"""
_PERIOD = 0.1
_STALE = 0.3
"""silence after which a heartbeat has stopped, s"""
_COUNTS = 251
_FIRST = 251
_ERROR = 254
_LEAVES = 255


class Heartbeat(Component):
    """A node's own heartbeat: 251 once, then 0 to 250 round and round, every 100 ms."""

    def __init__(self, node: IsobusNode) -> None:
        self._node = node
        self._cadence: Cadence | None = None
        self._count = _FIRST
        node.attach(self)

    def hear(self, time: float, message: Message) -> None:
        """Begin when asked to."""
        mine = message.destination in (GLOBAL, self._node.claim.address)
        if message.pgn == REPETITION_RATE and mine and message.data[:3] == HEARTBEAT.to_bytes(3, "little"):
            self._cadence = self._cadence or Cadence(_PERIOD)

    def frames(self, time: float) -> list[CanFrame]:
        """Return the count that is due."""
        if self._cadence is None or not self._node.claim.held or not self._cadence.due(time):
            return []
        data = bytes([self._count]) + b"\xff" * 7
        self._count = (self._count + 1) % _COUNTS if self._count < _COUNTS else 0
        return [self._node.frame(HEARTBEAT, data)]


class HeartbeatMonitor(Component):
    """Another device's heartbeat: alive while it counts on and says neither error nor farewell."""

    def __init__(self, node: IsobusNode, address: int) -> None:
        self._node, self._address = node, address
        self._count: int | None = None
        self._time = -math.inf
        self._good = False
        self.dropped: Counter[str] = Counter()
        """heartbeats out of sequence"""
        node.attach(self)

    def ask(self) -> CanFrame:
        """Return the frame that asks the device for its heartbeat; the node must hold its address."""
        data = HEARTBEAT.to_bytes(3, "little") + round(_PERIOD * 1e3).to_bytes(2, "little") + b"\xff" * 3
        return self._node.frame(REPETITION_RATE, data, self._address, priority=6)

    def hear(self, time: float, message: Message) -> None:
        """Take in a count."""
        if message.pgn != HEARTBEAT or message.source != self._address or not message.data:
            return
        count = message.data[0]
        first = self._count is None or self._count >= _COUNTS or count >= _COUNTS
        expected = first or count == (self._count or 0) + 1 or (self._count, count) == (_COUNTS - 1, 0)
        if not expected:
            self.dropped["out of sequence"] += 1
        self._good = expected and count not in (_ERROR, _LEAVES)
        self._count, self._time = count, time

    def alive(self, time: float) -> bool:
        """Return whether the device is alive."""
        return self._good and time - self._time <= _STALE
