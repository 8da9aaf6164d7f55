"""Shared socket: several boards behind one UDP port of this computer, each with a transport of its own.

All AIO boards send to port 9999 and AiO_26 obeys nothing that comes from another one, so two boards must share that
socket. What one transport writes goes to its own board only; what arrives is heard on all of them, and the boards are
told apart by their senders.
"""

from collections import deque
from collections.abc import Sequence
from typing import Protocol

from drawbar.transports.base import Received, Transport

_WAITING = 1000
"""datagrams kept for a transport that is not read; older ones are dropped and counted"""


class DatagramSocket(Protocol):
    """What is asked of the socket that is shared."""

    connected: bool
    trouble: str

    def fileno(self) -> int:
        """Return the descriptor to wait on."""

    def read(self) -> list[Received]:
        """Return the datagrams that have arrived."""

    def write_to(self, data: bytes, peer: tuple[str, int]) -> bool:
        """Send one datagram; return whether it was taken."""

    def close(self) -> None:
        """Close the socket."""


def share(socket: DatagramSocket, peers: Sequence[tuple[str, int]]) -> list[Transport]:
    """Return a transport to each of `peers`, host and port, over the socket, which closes with the last of them."""
    shared: list[_PeerTransport] = []
    shared += [_PeerTransport(socket, peer, shared) for peer in peers]
    return list(shared)


class _PeerTransport(Transport):
    """One peer's share of a socket."""

    def __init__(self, socket: DatagramSocket, peer: tuple[str, int], shared: list["_PeerTransport"]) -> None:
        self.connected, self.trouble, self.unsent = socket.connected, "", 0
        self.lost = 0
        """datagrams that nobody read in time"""
        self._socket, self._peer, self._shared = socket, peer, shared
        self._waiting: deque[Received] = deque(maxlen=_WAITING)

    def fileno(self) -> int:
        return self._socket.fileno() if self.connected else -1

    def read(self) -> list[Received]:
        if self.connected:
            arrived = self._socket.read()
            for each in self._shared:
                each.hand_over(arrived)
        received = list(self._waiting)
        self._waiting.clear()
        return received

    def hand_over(self, arrived: list[Received]) -> None:
        """Keep datagrams until they are read."""
        self.lost += max(len(self._waiting) + len(arrived) - _WAITING, 0)
        self._waiting.extend(arrived)

    def write(self, data: bytes) -> bool:
        taken = self.connected and self._socket.write_to(data, self._peer)
        reason = self._socket.trouble if self.connected else "not sent: the transport is closed"
        self.trouble = "" if taken else reason
        self.unsent += 0 if taken else len(data)
        return taken

    def close(self) -> None:
        self.connected = False
        if not any(each.connected for each in self._shared):
            self._socket.close()
