"""A GNSS receiver: its transport and its protocols together; epochs with monotonic times come out."""

import math
from collections import Counter
from typing import Protocol, Self

from pydantic import model_validator

from drawbar.protocols.agopengps.frame import PREFIX
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.transports.address import FileAddress, TransportText, UdpAddress, parse_transport
from drawbar.transports.base import Received, Transport

ANY = "0.0.0.0"
"""all addresses of this computer"""
CAN = "can:"
"""begins the address of a CAN bus"""


class ReceiverSettings(EpochSettings):
    """Section of one receiver."""

    transport: TransportText
    """where its bytes come from, e.g. serial:/dev/ttyACM0@460800, tcp://192.168.3.1:28784, udp://0.0.0.0:9999; of NMEA
    2000 as can:socketcan:can0"""
    sender: str = ""
    """address of the board whose datagrams are its, or of the receiver on its CAN bus; empty: the first that sends.
    Two boards send to the same port"""

    @property
    def is_on_can(self) -> bool:
        """Whether it sends NMEA 2000."""
        return self.transport.startswith(CAN)

    @property
    def is_without_heading(self) -> bool:
        """Whether its headings are ignored: on NMEA 2000, and two antennas are not stated."""
        return self.is_on_can and not self.antennas.baseline

    @property
    def is_recorded(self) -> bool:
        """Whether its bytes come from a file, which may be read twice."""
        return not self.is_on_can and isinstance(parse_transport(self.transport), FileAddress)

    @property
    def has_senders(self) -> bool:
        """Whether its transport reports the sender."""
        return self.is_on_can or isinstance(parse_transport(self.transport), UdpAddress)

    def is_at(self, place: tuple[str, int]) -> bool:
        """Whether its datagrams come to a host and port of this computer."""
        address = None if self.is_on_can else parse_transport(self.transport)
        if not isinstance(address, UdpAddress) or address.port != place[1]:
            return False
        return address.host == place[0] or ANY in (address.host, place[0])

    @model_validator(mode="after")
    def _sender_fits(self) -> Self:
        if self.is_on_can and self.sender and not (self.sender.isascii() and self.sender.isdigit()):
            raise ValueError(
                f"sender = {self.sender!r} is no address on a CAN bus; give a number from 0 to 253, as a text"
            )
        return self


class _Stream(Protocol):
    """Bytes of a receiver in, its epochs out."""

    @property
    def due(self) -> float: ...
    @property
    def dropped(self) -> Counter[str]: ...
    @property
    def frozen(self) -> int: ...

    kinds: Counter[str]

    def push(self, data: bytes, time: float) -> list[Epoch]: ...
    def poll(self, time: float) -> list[Epoch]: ...


class Receiver:
    """Reads one receiver. Call `poll` when the transport can be read, and not later than at `due`."""

    last_received: float
    """monotonic time of the last byte, -inf: never, s"""
    last: Epoch | None
    """the last epoch"""

    def __init__(self, transport: Transport, settings: ReceiverSettings) -> None:
        self.transport = transport
        self.last_received = -math.inf
        self.last = None
        self._stream = _stream(settings)
        self._sender = "" if settings.is_on_can else settings.sender
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
            if self._is_ours(received):
                self.last_received = received.time
                ended += self._stream.push(received.data, received.time)
        ended += self._stream.poll(time)
        self.last = ended[-1] if ended else self.last
        return ended

    def close(self) -> None:
        """Give the transport back."""
        self.transport.close()

    def _is_ours(self, received: Received) -> bool:
        """Whether bytes are this receiver's; a stream has no sender, and a board's replies come to the same port."""
        address = received.source.rpartition(":")[0]
        if address and received.data.startswith(PREFIX):
            self._others["reply of a board"] += 1
            return False
        self._sender = self._sender or address
        if address == self._sender or not address:
            return True
        self._others["datagram of another sender"] += 1
        return False


def _stream(settings: ReceiverSettings) -> _Stream:
    if settings.is_on_can:
        from drawbar.protocols.nmea2000.stream import Nmea2000Stream

        return Nmea2000Stream(settings, int(settings.sender) if settings.sender else None)
    from drawbar.protocols.gnss.stream import EpochStream  # its parsers come with an extra

    return EpochStream(settings)
