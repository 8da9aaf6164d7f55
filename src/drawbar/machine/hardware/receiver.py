"""A GNSS receiver: its transport and its protocols together; epochs with monotonic times come out."""

import math
from collections import Counter

from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.transports.base import Transport


class ReceiverSettings(EpochSettings):
    """Section of one receiver."""

    transport: str
    """where its bytes come from, e.g. serial:/dev/ttyACM0@460800, tcp://192.168.3.1:28784, udp://:9999"""
    sender: str = ""
    """address of the board whose datagrams are its; empty: the first that is heard. Two boards send to the same port"""


class Receiver:
    """Reads one receiver. Call `poll` when the transport can be read, and not later than at `due`."""

    heard: float
    """monotonic time of the last byte, -inf: never, s"""
    last: Epoch | None
    """the last epoch"""

    def __init__(self, transport: Transport, settings: ReceiverSettings) -> None:
        self.transport = transport
        self.heard = -math.inf
        self.last = None
        from drawbar.protocols.gnss.stream import EpochStream  # its parsers come with an extra

        self._stream = EpochStream(settings)
        self._sender = settings.sender
        self._others: Counter[str] = Counter()

    @property
    def due(self) -> float:
        """Monotonic time at which `poll` is to be called even if nothing comes, infinite: none, s."""
        return self._stream.due

    @property
    def dropped(self) -> Counter[str]:
        """What became of no epoch so far, by kind."""
        return self._stream.dropped + self._others

    @property
    def kinds(self) -> Counter[str]:
        """Messages understood so far, by kind."""
        return self._stream.kinds

    @property
    def frozen(self) -> int:
        """Epochs in a row that came with the time of the one before."""
        return self._stream.frozen

    def poll(self, time: float) -> list[Epoch]:
        """Read what has come until this monotonic time (s), and return the epochs that have ended."""
        ended: list[Epoch] = []
        for received in self.transport.read():
            if self._is_ours(received.source):
                self.heard = received.time
                ended += self._stream.push(received.data, received.time)
        ended += self._stream.poll(time)
        self.last = ended[-1] if ended else self.last
        return ended

    def close(self) -> None:
        """Give the transport back."""
        self.transport.close()

    def _is_ours(self, source: str) -> bool:
        """Whether bytes are this receiver's; a stream has no sender."""
        address = source.rpartition(":")[0]
        self._sender = self._sender or address
        if address == self._sender or not source:
            return True
        self._others["datagram of another sender"] += 1
        return False
