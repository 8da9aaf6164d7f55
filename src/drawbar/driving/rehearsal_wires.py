"""Wires of a rehearsal: transports and channels in memory, and the post between them, where faults are put in."""

import heapq
import itertools
from collections.abc import Callable, Iterable

from drawbar.transports.base import Received, Transport

Tap = Callable[[float, bytes], Iterable[tuple[float, bytes]]]
"""what becomes of bytes on their way, given the time (s): each of those that arrive, with its delay (s)"""


class MemoryTransport(Transport):
    """A wire in memory: `arrive` puts bytes in, `sent` holds what was written."""

    connected = True

    def __init__(self) -> None:
        """Begin empty."""
        self._arrived: list[Received] = []
        self.sent: list[bytes] = []

    def arrive(self, time: float, data: bytes, source: str = "") -> None:
        """Let bytes come at a time, s."""
        self._arrived.append(Received(time, data, source))

    def fileno(self) -> int:
        """Return -1: there is nothing to wait on."""
        return -1

    def read(self) -> list[Received]:
        """Return what has arrived."""
        arrived, self._arrived = self._arrived, []
        return arrived

    def write(self, data: bytes) -> bool:
        """Keep what is sent."""
        self.sent.append(data)
        return True

    def close(self) -> None:
        """Do nothing."""


class MemoryChannel:
    """The gate's channels to controller and operators, in memory: records in, records out."""

    def __init__(self) -> None:
        """Begin empty."""
        self.inbox: list[bytes] = []
        self.outbox: list[bytes] = []
        self.gone = False

    def receive(self, most: int) -> list[bytes]:
        """Return the controller's records."""
        records, self.inbox = self.inbox[:most], self.inbox[most:]
        return records

    def send(self, record: bytes) -> None:
        """Keep a record for the controller."""
        self.outbox.append(record)


class MemoryDesk(MemoryChannel):
    """As MemoryChannel, for operators."""

    def receive(self, most: int) -> list[tuple[bytes, str]]:  # type: ignore[override]
        """Return the operators' records."""
        return [(record, "") for record in super().receive(most)]

    def subscribe(self, sender: str) -> None:
        """Do nothing: everybody sees the outbox."""

    def publish(self, record: bytes) -> None:
        """Keep a record for the operators."""
        self.outbox.append(record)


class Post:
    """Carries bytes from part to part: at once, or as the tap on their way has it."""

    def __init__(self) -> None:
        """Begin without taps."""
        self.taps: dict[str, Tap] = {}
        """by the name of what is carried"""
        self._under_way: list[tuple[float, int, Callable[[bytes], None], bytes]] = []
        self._posted = itertools.count()

    def send(self, time: float, name: str, data: bytes, receive: Callable[[bytes], None]) -> None:
        """Carry bytes under a name to who receives them."""
        tap = self.taps.get(name)
        for delay, each in tap(time, data) if tap else ((0.0, data),):
            if delay > 0.0:
                heapq.heappush(self._under_way, (time + delay, next(self._posted), receive, each))
            else:
                receive(each)

    def deliver(self, time: float) -> None:
        """Let arrive what is due."""
        while self._under_way and self._under_way[0][0] <= time:
            _, _, receive, data = heapq.heappop(self._under_way)
            receive(data)
