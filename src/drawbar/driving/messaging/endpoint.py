"""Endpoint of a process: its datagrams with the others of a drive, by Unix sockets in one folder. No call waits."""

import os
import socket
import time
from collections import deque
from collections.abc import Iterator

from drawbar.realtime import say

LARGEST = 1 << 17
"""bytes of a datagram, at most"""
LARGEST_QUEUE = 1 << 22
"""bytes of what is queued and not taken yet; a minute of a drive"""
_CLOSING = 0.5
"""s"""
_BUFFER = 1 << 20
"""asked of the kernel for what was not read yet, bytes"""


class Endpoint:
    """One process's own socket: receives datagrams, and sends them to others; what was not taken is counted."""

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
        self._queue: deque[tuple[str, bytes]] = deque()
        self._queued_bytes = 0
        self._loss_reported = False
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
        """Send to another's path, without waiting for one that does not read or is gone."""
        try:
            self._socket.sendto(data, path)
        except OSError:
            self.lost += 1

    def send_queued(self, path: str, data: bytes) -> None:
        """Send to another's path; what it does not take now is queued, in order, and goes before what comes next.

        For what must not be lost, to one path only. The kernel keeps ten datagrams for a process that is busy.
        """
        self._queue.append((path, data))
        self._queued_bytes += len(data)
        self._send_queue()
        while self._queued_bytes > LARGEST_QUEUE:
            self._queued_bytes -= len(self._queue.popleft()[1])
            self.lost += 1
            self._report_loss(path)

    def _report_loss(self, path: str) -> None:
        """Print, once, that a reader does not keep up."""
        if not self._loss_reported:
            self._loss_reported = True
            names = os.path.basename(self._path), os.path.basename(path)
            say("{}: the {} does not keep up, and what it has not taken is lost; end other programs".format(*names))

    def _send_queue(self) -> None:
        while self._queue:
            path, data = self._queue[0]
            try:
                self._socket.sendto(data, path)
            except BlockingIOError:
                return
            except OSError:
                self.lost += 1
            self._queued_bytes -= len(self._queue.popleft()[1])

    def close(self) -> None:
        """Send what is queued, within half a second, close the socket and take its path away."""
        end = time.monotonic() + _CLOSING
        while self._queue and time.monotonic() < end:
            self._send_queue()
            time.sleep(0.005)
        self._socket.close()
        if os.path.exists(self._path):
            os.unlink(self._path)
