"""Connection: one attempt by TCP, with or without TLS; look the name up, connect, secure, use. No call waits."""

import errno
import os
import select
import socket
import ssl
import threading
from collections import deque
from enum import Enum

from drawbar.transports.tls import TlsLayer

PIECE = 65536
"""bytes taken from the socket at a time, unless given otherwise"""


class Phase(Enum):
    """How far a connection is."""

    RESOLVING = "looking up the name"
    CONNECTING = "connecting"
    SECURING = "agreeing on TLS"
    OPEN = "open"
    CLOSED = "closed"


class NameLookUp:
    """The addresses of a host, IPv4 first. A name is asked for in a thread, because that may take half a minute."""

    def __init__(self, host: str, port: int) -> None:
        self._host, self._port = host, port
        self.addresses: list[tuple[socket.AddressFamily, tuple[str, int]]] | None = None
        """None until they are known"""
        self.trouble = ""
        try:
            self._look_up(socket.AI_NUMERICHOST)
        except (OSError, UnicodeError):
            threading.Thread(target=self._in_thread, name=f"look-up of {host}", daemon=True).start()

    def _in_thread(self) -> None:
        try:
            self._look_up(0)
        except (OSError, UnicodeError) as error:
            self.trouble = f"the name {self._host} is not found ({error})"

    def _look_up(self, flags: int) -> None:
        found = socket.getaddrinfo(self._host, self._port, type=socket.SOCK_STREAM, flags=flags)
        usable = [(family, (str(place[0]), int(place[1]))) for family, _, _, _, place in found]
        self.addresses = sorted(usable, key=lambda address: address[0] != socket.AF_INET)


class Connection:
    """A TCP connection in the making, open, or closed for good; the owner decides when it took too long."""

    def __init__(self, host: str, port: int, tls: ssl.SSLContext | None = None, *, most: int = PIECE) -> None:
        """Begin; `most` bytes are taken from the socket at a time."""
        self.phase = Phase.RESOLVING
        self.trouble = ""
        """why it is closed, in words"""
        self._most = most
        self._tls = TlsLayer(tls, host) if tls else None
        self._look_up = NameLookUp(host, port)
        self._addresses: deque[tuple[socket.AddressFamily, tuple[str, int]]] = deque()
        self._socket: socket.socket | None = None

    def fileno(self) -> int:
        """Return the descriptor to wait on for bytes, -1 while there is none."""
        return self._socket.fileno() if self._socket else -1

    def advance(self) -> Phase:
        """Go on as far as goes without waiting, and return how far that is."""
        if self.phase is Phase.RESOLVING:
            self._resolve()
        if self.phase is Phase.CONNECTING:
            self._finish_connecting()
        if self.phase is Phase.SECURING:
            self._secure()
        return self.phase

    def read(self) -> bytes:
        """Return what has arrived, possibly nothing; where the other end is gone, `phase` is CLOSED then."""
        data = self._receive()
        if self._tls is None or self.phase not in (Phase.OPEN, Phase.CLOSED):
            return data
        try:
            plain = self._tls.opened(data)
        except ssl.SSLError as error:
            self.close(f"TLS: {error.reason or error}")
            return b""
        self._send_sealed()
        return plain

    def write(self, data: bytes) -> int:
        """Send now, and return how many bytes were taken; under TLS all of them, or the connection is closed."""
        if self.phase is not Phase.OPEN:
            return 0
        if self._tls is None:
            return self._send(data)
        try:
            self._tls.seal(data)
        except ssl.SSLWantReadError:
            self.close("TLS: the other end wants to agree again on it")
            return 0
        except ssl.SSLError as error:
            self.close(f"TLS: {error.reason or error}")
            return 0
        self._send_sealed()
        return len(data) if self.phase is Phase.OPEN else 0

    def close(self, trouble: str = "closed") -> None:
        """Give the socket back."""
        self.phase, self.trouble = Phase.CLOSED, trouble
        if self._socket:
            self._socket.close()
            self._socket = None

    def _resolve(self) -> None:
        if self._look_up.trouble:
            self.close(self._look_up.trouble)
        elif self._look_up.addresses is not None:
            self._addresses.extend(self._look_up.addresses)
            self._try_next("there is no address")

    def _try_next(self, trouble: str) -> None:
        """Begin with the next address; without one, the last one's trouble is the connection's."""
        while self._addresses:
            family, place = self._addresses.popleft()
            self.close()
            try:
                self._socket = socket.socket(family, socket.SOCK_STREAM)
                self._socket.setblocking(False)
                self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                code = self._socket.connect_ex(place)
            except OSError as error:
                code = error.errno or errno.EIO
            if code in (0, errno.EINPROGRESS):
                self.phase = Phase.CONNECTING
                return
            trouble = os.strerror(code)
        self.close(trouble)

    def _finish_connecting(self) -> None:
        while self._socket and self.phase is Phase.CONNECTING:
            poll = select.poll()
            poll.register(self._socket, select.POLLOUT)
            if not poll.poll(0):
                return
            code = self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
            if code:
                self._try_next(os.strerror(code))
            else:
                self.phase = Phase.SECURING if self._tls else Phase.OPEN

    def _secure(self) -> None:
        data = self._receive()
        if self._tls is None or self.phase is Phase.CLOSED:
            return
        try:
            agreed = self._tls.agree(data)
        except ssl.SSLError as error:
            self._send_sealed()
            self.close(f"TLS: {getattr(error, 'verify_message', '') or error.reason or error}")
            return
        self._send_sealed()
        if agreed and self.phase is Phase.SECURING:
            self.phase = Phase.OPEN

    def _receive(self) -> bytes:
        if not self._socket:
            return b""
        try:
            data = self._socket.recv(self._most)
        except (BlockingIOError, InterruptedError):
            return b""
        except OSError as error:
            self.close(error.strerror or str(error))
            return b""
        if not data:
            self.close("the other end has closed the connection")
        return data

    def _send(self, data: bytes) -> int:
        if not self._socket:
            return 0
        try:
            return self._socket.send(data)
        except (BlockingIOError, InterruptedError):
            return 0
        except OSError as error:
            self.close(error.strerror or str(error))
            return 0

    def _send_sealed(self) -> None:
        if self._tls:
            self._tls.sent(self._send(self._tls.sealed()))
            if self._tls.stuck:
                self.close("the other end takes no more bytes")
