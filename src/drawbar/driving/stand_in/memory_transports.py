"""Memory transports: wires and channels that are lists, for a drive in one process."""

from collections.abc import Callable

from drawbar.transports.base import CanBus, CanFrame, Received, Transport


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

    def put(self, record: bytes) -> None:
        """Take in a record, whenever it comes: the inbox is another list each time that it was read."""
        self.inbox.append(record)

    def send(self, record: bytes) -> None:
        """Keep a record for the controller."""
        self.outbox.append(record)


class MemoryOperatorChannel(MemoryChannel):
    """As MemoryChannel, for operators."""

    def receive(self, most: int) -> list[tuple[bytes, str]]:  # type: ignore[override]
        """Return the operators' records."""
        return [(record, "") for record in super().receive(most)]

    def subscribe(self, sender: str) -> None:
        """Do nothing: everybody sees the outbox."""

    def publish(self, record: bytes) -> None:
        """Keep a record for the operators."""
        self.outbox.append(record)


class MemoryBus(CanBus):
    """One end of a CAN bus in memory: what is written here is read at all other ends, at once."""

    connected = True

    def __init__(self, ends: list["MemoryBus"], now: Callable[[], float]) -> None:
        """Join the other ends; `now` is the clock, s."""
        self._ends, self._now = ends, now
        self._inbox: list[tuple[float, CanFrame]] = []
        ends.append(self)

    def fileno(self) -> int:
        """Return -1: there is nothing to wait on."""
        return -1

    def read(self) -> list[tuple[float, CanFrame]]:
        """Return what has arrived."""
        frames, self._inbox = self._inbox, []
        return frames

    def write(self, frame: CanFrame) -> bool:
        """Hand the frame to all other ends."""
        for end in self._ends:
            if end is not self:
                end._inbox.append((self._now(), frame))
        return True

    def close(self) -> None:
        """Do nothing."""
