"""Shared socket: several boards behind one UDP port of this computer, each with a transport of its own.

All AIO boards send to port 9999 and AiO_26 obeys nothing that comes from another one, so two boards must share that
socket. What one transport writes goes to its own board only; what arrives is received on all of them, and the sender
identifies the board.
"""

import socket
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from typing import Protocol

from drawbar.transports.base import Received, Transport

_WAITING = 1000
"""datagrams kept for a transport that is not read; older ones are dropped and counted"""


class DatagramSocket(Protocol):
    """What is asked of the socket that is shared."""

    @property
    def connected(self) -> bool:
        """Whether it is open."""

    @property
    def trouble(self) -> str:
        """What was last not sent, in words for the operator."""

    def fileno(self) -> int:
        """Return the descriptor to wait on."""

    def read(self) -> list[Received]:
        """Return the datagrams that have arrived."""

    def write_to(self, data: bytes, peer: tuple[str, int]) -> bool:
        """Send one datagram; return whether it was taken."""

    def close(self) -> None:
        """Close the socket."""


def share(
    line: DatagramSocket, peers: Sequence[tuple[str, int]], listeners: Sequence[Transport] = ()
) -> list[Transport]:
    """Return a transport to each of `peers`, host and port, over the socket `line`.

    What arrives at `listeners` is received as well; nothing is sent there. One on port 8888 receives the set points
    that another computer broadcasts to the boards. Socket and listeners close with the last of the transports.
    """
    shared: list[_PeerTransport] = []
    shared += [_PeerTransport(line, peer, shared, listeners) for peer in peers]
    return list(shared)


def own_sources(peers: Sequence[tuple[str, int]], port: int) -> frozenset[str]:
    """Return the `address:port` that datagrams from this computer's `port` to `peers` carry as their sender.

    A peer that cannot be reached now gives none.
    """
    sources = set()
    for peer in peers:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
            with suppress(OSError):
                probe.connect(peer)  # sends nothing: it only chooses the interface
                sources.add(f"{probe.getsockname()[0]}:{port}")
    return frozenset(sources)


class _PeerTransport(Transport):
    """One peer's share of a socket."""

    def __init__(
        self,
        line: DatagramSocket,
        peer: tuple[str, int],
        shared: list["_PeerTransport"],
        listeners: Sequence[Transport],
    ) -> None:
        self.connected, self.trouble, self.unsent = line.connected, "", 0
        self.lost = 0
        """datagrams that nobody read in time"""
        self._line, self._peer, self._shared, self._listeners = line, peer, shared, listeners
        self._waiting: deque[Received] = deque(maxlen=_WAITING)

    def fileno(self) -> int:
        return self._line.fileno() if self.connected else -1

    def read(self) -> list[Received]:
        if self.connected:
            arrived = self._line.read() + [each for listener in self._listeners for each in listener.read()]
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
        taken = self.connected and self._line.write_to(data, self._peer)
        reason = self._line.trouble if self.connected else "not sent: the transport is closed"
        self.trouble = "" if taken else reason
        self.unsent += 0 if taken else len(data)
        return taken

    def close(self) -> None:
        self.connected = False
        if not any(each.connected for each in self._shared):
            self._line.close()
            for listener in self._listeners:
                listener.close()
