"""Socket passing (SCM_RIGHTS): the receiver sends from the same port as the sender, also after the sender's end."""

import socket

_LONGEST = 64
"""bytes of a socket's name"""


def pass_socket(path: str, name: str, descriptor: int) -> None:
    """Pass a socket to the receiver at a path; OSError: there is none."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as wire:
        wire.connect(path)
        socket.send_fds(wire, [name.encode()], [descriptor])


class SocketReceiver:
    """Receives at a path the sockets that are passed to it."""

    def __init__(self, path: str) -> None:
        """Open the path, where nothing may be."""
        self._wire = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._wire.setblocking(False)
        self._wire.bind(path)

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._wire.fileno()

    def take(self) -> dict[str, socket.socket]:
        """Return the sockets that have been passed since the last call, by name."""
        passed: dict[str, socket.socket] = {}
        while True:
            try:
                name, descriptors, _, _ = socket.recv_fds(self._wire, _LONGEST, 1)
            except BlockingIOError:
                return passed
            passed |= {name.decode(): socket.socket(fileno=descriptor) for descriptor in descriptors}

    def close(self) -> None:
        """Take no more."""
        self._wire.close()
