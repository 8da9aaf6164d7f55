"""Lent sockets: a process hands its sockets to another, which then sends from the same ports, also after its end."""

import socket

_LONGEST = 64
"""bytes of a socket's name"""


def lend(path: str, name: str, descriptor: int) -> None:
    """Hand a socket to the borrower at a path; OSError: there is none."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as wire:
        wire.connect(path)
        socket.send_fds(wire, [name.encode()], [descriptor])


class Borrower:
    """Waits at a path for sockets that are lent."""

    def __init__(self, path: str) -> None:
        """Open the path, where nothing may be."""
        self._wire = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._wire.setblocking(False)
        self._wire.bind(path)

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._wire.fileno()

    def take(self) -> dict[str, socket.socket]:
        """Return the sockets that have been lent since the last call, by name."""
        lent: dict[str, socket.socket] = {}
        while True:
            try:
                name, descriptors, _, _ = socket.recv_fds(self._wire, _LONGEST, 1)
            except BlockingIOError:
                return lent
            lent |= {name.decode(): socket.socket(fileno=descriptor) for descriptor in descriptors}

    def close(self) -> None:
        """Take no more."""
        self._wire.close()
