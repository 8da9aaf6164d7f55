"""Sentences: what AgOpenGPS boards send as receivers (PANDA, PAOGI), passed on by the gate.

Boards send sentences and replies to one port, 9999, and the gate alone listens there. It passes each datagram that
begins as a sentence, with its stamp and its sender, through a Unix socket to the receivers. Without numpy: the gate
uses it.
"""

import os
import socket
import struct
from contextlib import suppress

from drawbar.machine.hardware.shared_socket import DatagramSocket
from drawbar.transports.base import Received

_BEGINS = b"$"
_STAMP = struct.Struct("<dB")
"""time, s, and the length of the sender that follows, bytes"""
_LARGEST = 65536 + 64
_AT_ONCE = 100


class SentenceRelay:
    """A socket of boards, whose sentences go to a path; all else is read here."""

    def __init__(self, line: DatagramSocket, path: str) -> None:
        self._line, self._path = line, path
        self._out = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._out.setblocking(False)

    @property
    def connected(self) -> bool:
        """Whether the relay of the boards' sentences is open."""
        return self._line.connected

    @property
    def trouble(self) -> str:
        """What was last not sent to a board."""
        return self._line.trouble

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._line.fileno()

    def read(self) -> list[Received]:
        """Return the datagrams that have arrived and are no sentences; hand the sentences on."""
        kept = []
        for each in self._line.read():
            if each.data.startswith(_BEGINS):
                sender = each.source.encode("ascii")
                with suppress(OSError):  # a reader that does not read is not waited for
                    self._out.sendto(_STAMP.pack(each.time, len(sender)) + sender + each.data, self._path)
            else:
                kept.append(each)
        return kept

    def write_to(self, data: bytes, peer: tuple[str, int]) -> bool:
        """Send one datagram; return whether it was taken."""
        return self._line.write_to(data, peer)

    def close(self) -> None:
        """Close both sockets."""
        self._out.close()
        self._line.close()


class RelayedSentences:
    """The other end of relays: the sentences that they hand on."""

    connected = True
    trouble = ""

    def __init__(self, path: str) -> None:
        """Open it at a path, where nothing may be.

        Raises OSError where it cannot be.
        """
        self._path = path
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._socket.bind(path)

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._socket.fileno()

    def read(self) -> list[Received]:
        """Return the sentences that have arrived, with the times at which the boards' socket had them."""
        received: list[Received] = []
        while len(received) < _AT_ONCE:
            try:
                data = self._socket.recv(_LARGEST)
            except (BlockingIOError, InterruptedError):
                break
            time, length = _STAMP.unpack_from(data)
            place = _STAMP.size + length
            received.append(Received(time, data[place:], data[_STAMP.size : place].decode("ascii")))
        return received

    def write_to(self, data: bytes, peer: tuple[str, int]) -> bool:
        """Return False: nothing can be sent this way."""
        self.trouble = (
            f"not sent: {len(data)} bytes for a receiver on a board ({peer[0]}); boards take them at port 2233"
        )
        return False

    def close(self) -> None:
        """Close it, and take the path away."""
        self._socket.close()
        with suppress(OSError):
            os.unlink(self._path)
