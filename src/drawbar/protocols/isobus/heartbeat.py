"""Heartbeat: the counter by which others see that a device is alive, sent once it has been requested (0xF0E4)."""

from drawbar.protocols.isobus.cadence import Cadence
from drawbar.protocols.isobus.identifier import GLOBAL, Message
from drawbar.protocols.isobus.node import Component, IsobusNode
from drawbar.transports.base import CanFrame

HEARTBEAT = 0xF0E4
REPETITION_RATE = 0xCC00
"""request for a group to be repeated: its number in three bytes, the period in ms in two"""
_PERIOD = 0.1
_COUNTS = 251
_FIRST = 251


class Heartbeat(Component):
    """A node's own heartbeat: 251 once, then 0 to 250 round and round, every 100 ms."""

    def __init__(self, node: IsobusNode) -> None:
        self._node = node
        self._cadence: Cadence | None = None
        self._count = _FIRST
        node.attach(self)

    def receive_message(self, time: float, message: Message) -> None:
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
