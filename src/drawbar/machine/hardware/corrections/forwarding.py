"""Forwarding of corrections: to streams at once, to boards by UDP in small pieces, as their buffers need it."""

from collections import Counter

from drawbar.transports.base import Transport

PIECE = 256
"""boards cut longer datagrams, bytes"""
INTERVAL = 0.02
"""between datagrams at least, s"""
WAITING = 8192
"""bytes that may wait for a board; more come only after a jam, and the oldest are dropped"""


class StreamOutlet:
    """A serial line or a TCP connection of its own, that takes corrections unchanged and sends nothing of use."""

    def __init__(self, transport: Transport) -> None:
        self.transport = transport

    def advance(self, now: float, data: bytes) -> None:
        """Send what came."""
        self.transport.read()  # opens a lost connection again
        if data:
            self.transport.write(data)


class PacedOutlet:
    """A board that takes corrections by UDP: at most `PIECE` bytes each `INTERVAL`."""

    def __init__(self, transport: Transport) -> None:
        self.transport = transport
        self.dropped: Counter[str] = Counter()
        """`bytes` that came faster than the board takes them"""
        self._waiting = bytearray()
        self._next = float("-inf")

    def advance(self, now: float, data: bytes) -> None:
        """Take what came, and send a piece when it is time."""
        self.transport.read()  # what a board answers would fill the socket
        self._waiting += data
        excess = max(0, len(self._waiting) - WAITING)
        self.dropped["bytes"] += excess
        del self._waiting[:excess]
        if self._waiting and now >= self._next:
            self.transport.write(bytes(self._waiting[:PIECE]))
            del self._waiting[:PIECE]
            self._next = now + INTERVAL
