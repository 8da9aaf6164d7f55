"""Transports of the stand-in's devices: sockets, pseudo-terminals and a CAN bus, where a configuration has devices."""

import errno
import os
import socket
import tty
from contextlib import suppress
from urllib.parse import urlsplit

from drawbar.errors import HardwareError
from drawbar.machine.hardware.receiver import ANY, CAN
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.machine.stand_in.board import Output
from drawbar.transports.address import SerialAddress, parse_transport
from drawbar.transports.can_listener import unpacked
from drawbar.transports.open import open_can

_TERMINALS = "/dev/pts/"
"""where Linux has its pseudo-terminals"""


class DataLine:
    """Where the bytes of a receiver or a sensor board go: everybody who is connected to its TCP port, or a UDP port."""

    def __init__(self, address: str, sender: str = "") -> None:
        """Open it; of datagrams the sender, an address of this computer, may be told.

        Raises:
            HardwareError: the port is taken, or a stand-in cannot be at such an address.
        """
        parts = urlsplit(address)
        if parts.scheme not in ("tcp", "udp") or parts.port is None:
            raise HardwareError(
                f"a stand-in cannot be at {address}; give tcp://HOST:PORT, udp://HOST:PORT or serial:NAME@BAUD"
            )
        self._place = (parts.hostname or "127.0.0.1", parts.port)
        self._peers: list[socket.socket] = []
        self._listens = parts.scheme == "tcp"
        if self._listens:
            self._socket = _bound(socket.SOCK_STREAM, self._place, address)
            self._socket.listen()
        else:
            self._socket = _bound(socket.SOCK_DGRAM, (sender, 0), sender)

    def send(self, data: bytes) -> None:
        """Send to all that are connected."""
        if not self._listens:
            self._socket.sendto(data, self._place)
            return
        with suppress(BlockingIOError):  # no new connection
            self._peers.append(self._socket.accept()[0])
            self._peers[-1].setblocking(False)
        for peer in list(self._peers):
            try:
                peer.send(data)
            except OSError:
                peer.close()
                self._peers.remove(peer)

    def receive(self) -> bytes:
        """Return what those have sent who are connected."""
        came = b""
        for peer in self._peers:
            with suppress(OSError):  # nothing, or it has gone; `send` sees that
                came += peer.recv(4096)
        return came

    @property
    def is_writable(self) -> bool:
        """Whether it takes in what is sent to it."""
        return self._listens

    def close(self) -> None:
        """Close all sockets."""
        for each in (*self._peers, self._socket):
            each.close()


class SerialLine:
    """A pseudo-terminal under the name of a serial line: a program that opens it talks to the stand-in."""

    is_writable = True

    def __init__(self, address: str) -> None:
        """Open it, and give it the name.

        Raises:
            HardwareError: something else has the name, or this user may not give it.
        """
        parsed = parse_transport(address)
        assert isinstance(parsed, SerialAddress)
        self._name = parsed.device
        self._own, self._other = os.openpty()
        for end in (self._own, self._other):
            tty.setraw(end)
        os.set_blocking(self._own, False)
        try:
            if os.path.islink(self._name) and os.readlink(self._name).startswith(_TERMINALS):
                os.unlink(self._name)  # of a stand-in that was killed
            os.symlink(os.ttyname(self._other), self._name)
        except OSError as error:
            self._close()
            raise HardwareError(
                f"the stand-in cannot be at {address}: it would give a pseudo-terminal the name {self._name} "
                f"({error.strerror}); name a file that there is not yet, as serial:/tmp/receiver@460800"
            ) from None

    def send(self, data: bytes) -> None:
        """Send to who has opened it; what nobody reads is lost, as on a wire."""
        with suppress(BlockingIOError):
            os.write(self._own, data)

    def receive(self) -> bytes:
        """Return what was sent by who has opened it."""
        with suppress(BlockingIOError):
            return os.read(self._own, 4096)
        return b""

    def close(self) -> None:
        """Take the name away and close it."""
        with suppress(OSError):  # somebody else has taken it away
            os.unlink(self._name)
        self._close()

    def _close(self) -> None:
        os.close(self._own)
        os.close(self._other)


class BoardLine:
    """The UDP socket of a board."""

    def __init__(self, settings: SteerBoardSettings) -> None:
        """Listen at the board's address.

        Raises:
            HardwareError: the port is taken.
        """
        self._socket = _bound(socket.SOCK_DGRAM, settings.destination, settings.address)
        host, port = settings.listening
        self._computer = ("127.0.0.1" if host == ANY else host, port)

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._socket.fileno()

    def receive(self) -> list[tuple[bytes, int]]:
        """Return the datagrams that have come, with their senders' ports."""
        came: list[tuple[bytes, int]] = []
        while len(came) < 64:
            try:
                data, self._computer = self._socket.recvfrom(2048)
            except BlockingIOError:
                break
            came.append((data, self._computer[1]))
        return came

    def send(self, output: Output) -> None:
        """Send to the computer that sent last; before, to this one, as a board's broadcast reaches it."""
        with suppress(OSError):  # there is no listener
            self._socket.sendto(output.data, self._computer)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class CanLine:
    """The CAN bus of an NMEA 2000 receiver."""

    def __init__(self, address: str) -> None:
        """Open it."""
        self._bus = open_can(address)

    def send(self, data: bytes) -> None:
        """Send a packed frame."""
        frame = unpacked(data)
        if frame is not None:
            self._bus.write(frame)
            self._bus.read()  # nobody else does

    def close(self) -> None:
        """Close the bus."""
        self._bus.close()


def _bound(kind: socket.SocketKind, place: tuple[str, int], address: str) -> socket.socket:
    """Return a socket at a place, which the configuration calls so.

    Raises:
        HardwareError: the port is taken, or the address is not this computer's.
    """
    bound = socket.socket(socket.AF_INET, kind)
    bound.setblocking(False)
    try:
        if kind is socket.SOCK_STREAM:
            bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # after a stand-in that ended just now
        bound.bind(place)
    except OSError as error:
        bound.close()
        advice = "end the program that is there"
        if error.errno == errno.EADDRNOTAVAIL:
            advice = "give this computer that address, or put one of 127.0.0.x in its place in a copy of the file"
        raise HardwareError(f"the stand-in cannot be at {address} ({error.strerror}); {advice}") from None
    return bound


def open_line(address: str, sender: str = "") -> DataLine | SerialLine | CanLine:
    """Return the stand-in's end of what a configuration calls so.

    Raises:
        HardwareError: the port is taken, or a stand-in cannot be at such an address.
    """
    return CanLine(address) if address.startswith(CAN) else open_data_line(address, sender)


def open_data_line(address: str, sender: str = "") -> DataLine | SerialLine:
    """Return the stand-in's end of a line that carries bytes.

    Raises:
        HardwareError: as `open_line`; or it is a CAN bus.
    """
    return SerialLine(address) if address.startswith("serial:") else DataLine(address, sender)
