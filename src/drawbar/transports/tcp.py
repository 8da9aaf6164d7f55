"""TCP clients: connect, notice a dead other end by its silence, and connect again, ever more slowly."""

import time

from drawbar.transports.address import TcpAddress
from drawbar.transports.base import Received, Transport
from drawbar.transports.clock import Clock
from drawbar.transports.connection import Connection, Phase

BACK_OFF = (1.0, 2.0, 5.0, 10.0)
"""pauses before the attempts that follow one another without a byte, s; the last one continues"""
ATTEMPT = 5.0
"""an attempt that is not through by then is given up, s"""


class TcpTransport(Transport):
    """A TCP client. `read` does all the work; call it at least every 0.1 s even where nothing can be read."""

    def __init__(self, address: TcpAddress, clock: Clock = time.monotonic) -> None:
        self.address = address
        self.connected = False
        self._clock = clock
        self._failures = 0
        self._connection: Connection | None = None
        self._next = clock()
        """when the next attempt begins, s"""
        self._deadline = 0.0
        """when the attempt, or the silence, has lasted too long, s"""

    def fileno(self) -> int:
        """Return the descriptor to wait on, -1 while there is none."""
        return self._connection.fileno() if self._connection else -1

    def read(self) -> list[Received]:
        """Return what has arrived, as one piece; connect when it is time."""
        now = self._clock()
        if self._connection is None:
            self._begin(now)
        connection = self._connection
        if connection is None:
            return []
        opened = connection.advance() is Phase.OPEN
        if opened and not self.connected:
            self.connected, self.trouble, self._deadline = True, "", now + self.address.silence
        data = connection.read() if opened else b""
        if data:
            self._failures, self._deadline = 0, now + self.address.silence
        elif connection.phase is Phase.CLOSED:
            self._lose(connection.trouble)
        elif now >= self._deadline:
            self._lose(f"no byte for {self.address.silence:g} s" if self.connected else "no answer")
        return [Received(now, data)] if data else []

    def write(self, data: bytes) -> bool:
        """Send now, and return whether all of it was taken."""
        taken = self._connection.write(data) if self._connection else 0
        self.unsent += len(data) - taken
        return taken == len(data)

    def close(self) -> None:
        """Close the connection."""
        self.connected = False
        if self._connection:
            self._connection.close()
            self._connection = None

    def _begin(self, now: float) -> None:
        if now >= self._next:
            self._connection = Connection(self.address.host, self.address.port)
            self._deadline = now + ATTEMPT

    def _lose(self, reason: str) -> None:
        self.close()
        pause = BACK_OFF[min(self._failures, len(BACK_OFF) - 1)]
        self._failures += 1
        self._next = self._clock() + pause
        self.trouble = f"{self.address.host}:{self.address.port}: {reason}; next attempt in {pause:g} s"
