"""Memory: transports and channels of a rehearsal, without sockets."""

from drawbar.transports.base import Received, Transport


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
