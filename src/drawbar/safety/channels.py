"""Channels of the gate: the controller's socket pair, the operators' Unix socket, and the subscribers of its state.

No call waits. A channel holds what the kernel's buffers hold, and nothing grows.
"""

import os
import socket
import stat

from drawbar.errors import HardwareError

SUBSCRIBERS = 16
"""most addresses to which the gate's state is sent; the one that subscribed first makes room"""
LARGEST = 4096
"""bytes taken of a datagram; longer than any record"""


def controller_pair() -> tuple[socket.socket, socket.socket]:
    """Return the two ends between controller and gate: whole records, in order, and an end that is seen.

    Whoever starts the processes gives one end to each and closes its own copies, else neither sees the other's end.
    """
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    return ours, theirs


def open_operator_socket(path: str) -> socket.socket:
    """Open the operators' socket at a path, for this user only.

    Raises:
        HardwareError: it cannot be opened there.
    """
    operators = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    before = os.umask(0o177)
    try:
        if os.path.exists(path) and stat.S_ISSOCK(os.stat(path).st_mode):
            os.unlink(path)  # left by a gate that was killed
        operators.bind(path)
    except OSError as error:
        operators.close()
        raise HardwareError(
            f"the operators' socket {path} cannot be opened: {error}. Give the path of a new file, shorter than 100 "
            f"characters, in a folder of your own."
        ) from error
    finally:
        os.umask(before)
    return operators


class ControllerChannel:
    """The gate's end of the pair; `gone` once the other end is closed, by whatever ended the controller."""

    def __init__(self, end: socket.socket) -> None:
        """Take the end."""
        end.setblocking(False)
        self._socket = end
        self.gone = False

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._socket.fileno()

    def receive(self, most: int) -> list[bytes]:
        """Return the records that have arrived, at most so many; the others stay."""
        records: list[bytes] = []
        while len(records) < most and not self.gone:
            try:
                record = self._socket.recv(LARGEST)
            except BlockingIOError:
                break
            except OSError:
                record = b""
            self.gone = not record
            records += [record] if record else []
        return records

    def send(self, record: bytes) -> None:
        """Send; a controller that does not read is not waited for."""
        _offer(self._socket, record, None)

    def close(self) -> None:
        """Close this end."""
        self._socket.close()


class OperatorChannel:
    """The operators' socket, and the subscribers of the gate's state: given at the start, or senders of a message."""

    def __init__(self, operators: socket.socket, subscribers: tuple[str, ...]) -> None:
        """Take the bound socket, and the paths of permanent subscribers."""
        operators.setblocking(False)
        self._socket, self._fixed = operators, subscribers
        self._senders: dict[str, None] = {}

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._socket.fileno()

    def receive(self, most: int) -> list[tuple[bytes, str]]:
        """Return the datagrams that have arrived with their senders' paths, at most so many; the others stay."""
        records: list[tuple[bytes, str]] = []
        while len(records) < most:
            try:
                record, sender = self._socket.recvfrom(LARGEST)
            except OSError:
                break
            records.append((record, sender if isinstance(sender, str) else ""))
        return records

    def subscribe(self, sender: str) -> None:
        """Add a subscriber; a sender without a path of its own cannot be one."""
        if sender and sender not in self._fixed:
            self._senders[sender] = None
            if len(self._senders) > SUBSCRIBERS:
                del self._senders[next(iter(self._senders))]

    def publish(self, record: bytes) -> None:
        """Send to all without waiting for any of them; a sender that is gone is forgotten."""
        for path in self._fixed:
            _offer(self._socket, record, path)
        for path in [path for path in self._senders if not _offer(self._socket, record, path)]:
            del self._senders[path]

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


def _offer(end: socket.socket, record: bytes, path: str | None) -> bool:
    """Send without waiting; return whether the receiver still exists."""
    try:
        if path is None:
            end.send(record)
        else:
            end.sendto(record, path)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return True
