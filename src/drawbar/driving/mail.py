"""Mail: datagrams between the processes of a drive, by Unix sockets in a folder of the drive's own. No call waits."""

import os
import socket
from collections.abc import Iterator

LARGEST = 1 << 17
"""bytes of a datagram, at most"""
_BUFFER = 1 << 20
"""asked of the kernel for what was not read yet, bytes"""


class Mailbox:
    """One process's own socket: takes datagrams, and sends them to others; what nobody takes is counted."""

    def __init__(self, path: str) -> None:
        """Open the socket at a path, where none may be.

        Raises:
            OSError: it cannot be.
        """
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        for option in (socket.SO_RCVBUF, socket.SO_SNDBUF):
            self._socket.setsockopt(socket.SOL_SOCKET, option, _BUFFER)
        self._path = path
        self._socket.bind(path)
        self.lost = 0
        """datagrams that were not taken"""

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._socket.fileno()

    def receive(self, most: int = 256) -> Iterator[bytes]:
        """Yield what has arrived, at most so many datagrams."""
        for _ in range(most):
            try:
                yield self._socket.recv(LARGEST)
            except OSError:
                return

    def send(self, path: str, data: bytes) -> None:
        """Send to another's path; whoever does not read, or is gone, is not waited for."""
        try:
            self._socket.sendto(data, path)
        except OSError:
            self.lost += 1

    def close(self) -> None:
        """Close the socket and take its path away."""
        self._socket.close()
        if os.path.exists(self._path):
            os.unlink(self._path)
