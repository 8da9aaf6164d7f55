"""Base of every byte transport, its one interface: serial line, TCP, UDP, file."""

from abc import ABC, abstractmethod
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Received:
    """Bytes as they came."""

    time: float
    """monotonic clock when the first of them was there, s"""
    data: bytes
    """one datagram, or whatever a stream held"""
    source: str = ""
    """`address:port` of the sender of a datagram; empty: a stream"""


@dataclass(frozen=True, slots=True)
class CanFrame:
    """One frame of a CAN bus with 29-bit identifiers."""

    identifier: int
    data: bytes


class Transport(ABC):
    """Bytes in and out. No call waits; a lost connection is opened again by itself; until then `connected` is False."""

    connected: bool
    trouble: str = ""
    """why it is not connected, or what was last not sent, in words for the operator; empty: nothing to report"""
    unsent: int = 0
    """bytes that `write` was given and the device did not take"""

    @abstractmethod
    def fileno(self) -> int:
        """Return the descriptor to wait on, -1 while there is none; another one after each connection."""

    @abstractmethod
    def read(self) -> list[Received]:
        """Return what has arrived since the last call: each datagram by itself, or at most one piece of a stream."""

    @abstractmethod
    def write(self, data: bytes) -> bool:
        """Send now, and return whether all of it was taken; what was not is counted and dropped, never queued."""

    @abstractmethod
    def close(self) -> None:
        """Give the device back."""


class CanBus(ABC):
    """Frames in and out of one CAN bus. No call waits; a lost bus is opened again by itself."""

    connected: bool
    trouble: str = ""
    """why it is not connected, or what was last not sent, in words for the operator; empty: nothing to report"""
    unsent: int = 0
    """frames that `write` was given and the bus did not take"""

    @abstractmethod
    def fileno(self) -> int:
        """Return the descriptor to wait on, -1 where the bus has none and must be asked again and again."""

    @abstractmethod
    def read(self) -> list[tuple[float, CanFrame]]:
        """Return the frames that have arrived since the last call, each with its monotonic time, s."""

    @abstractmethod
    def write(self, frame: CanFrame) -> bool:
        """Send now, and return whether it was taken."""

    @abstractmethod
    def close(self) -> None:
        """Give the bus back."""
