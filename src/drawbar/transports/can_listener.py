"""Listening to a CAN bus as to any other transport: each frame as bytes, so that it is recorded as all bytes are."""

from drawbar.transports.base import CanBus, CanFrame, Received, Transport

_IDENTIFIER = 4
"""bytes before the data, little-endian"""


def packed(frame: CanFrame) -> bytes:
    """Return a frame as bytes: its identifier in four, then its data."""
    return frame.identifier.to_bytes(_IDENTIFIER, "little") + frame.data


def unpacked(data: bytes) -> CanFrame | None:
    """Return the frame in bytes; None: there is none."""
    if not _IDENTIFIER <= len(data) <= _IDENTIFIER + 8:
        return None
    return CanFrame(int.from_bytes(data[:_IDENTIFIER], "little"), data[_IDENTIFIER:])


class CanListener(Transport):
    """The frames of a bus as `packed` bytes. Nothing is ever sent."""

    def __init__(self, bus: CanBus) -> None:
        """Take the open bus."""
        self._bus = bus
        self._follow()

    def fileno(self) -> int:
        """Return the bus's descriptor."""
        return self._bus.fileno()

    def read(self) -> list[Received]:
        """Return the frames that have arrived."""
        frames = self._bus.read()
        self._follow()
        return [Received(time, packed(frame)) for time, frame in frames]

    def write(self, data: bytes) -> bool:
        """Refuse: a receiver on a CAN bus takes nothing from drawbar."""
        self.unsent += len(data)
        return False

    def close(self) -> None:
        """Give the bus back."""
        self._bus.close()
        self._follow()

    def _follow(self) -> None:
        self.connected, self.trouble = self._bus.connected, self._bus.trouble
