"""An NTRIP caster on loopback, in every dialect and with every fault that casters have."""

import base64
import select
import socket
import ssl
import struct
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from random import Random
from types import TracebackType
from typing import Self

from drawbar.protocols.rtcm import rtcm_frame

LONGEST_REQUEST = 8192
IDLE = 2.0
"""a client that is silent for so long is disconnected, s"""


class Dialect(Enum):
    """How a caster answers."""

    V1 = "version 1"
    V1_ONE_LINE_END = "version 1 with one line end after ICY 200 OK"
    V2_PLAIN = "version 2, plain until the end"
    V2_CHUNKED = "version 2, chunked, with cuts inside frames"


class CasterFault(Enum):
    """What goes wrong; from CLOSE on after some good epochs."""

    NONE = "nothing"
    UNAUTHORIZED = "401 whatever the login"
    NOT_FOUND = "404 whatever the mount point"
    CLOSE = "closes the connection"
    RESET = "resets the connection"
    STALL = "keeps the connection and sends nothing more"
    DRIP = "sends byte by byte, one each interval"
    GARBAGE = "sends noise"


def empty_corrections(epoch: int, station: int = 123) -> bytes:
    """Return what a caster sends in an epoch (each second): MSM7 of GPS without a satellite, and 1005 every tenth."""
    seconds = epoch % 604800
    msm = 1077 << 157 | station << 145 | seconds * 1000 << 115  # 169 bits of header, all masks empty, then padding
    frames = rtcm_frame((msm << 7).to_bytes(22, "big"))
    if epoch % 10 == 0:
        place = 1005 << 140 | station << 128  # at the centre of the earth
        frames += rtcm_frame(place.to_bytes(19, "big"))
    return frames


@dataclass(frozen=True, slots=True, kw_only=True)
class CasterSettings:
    """What a caster serves, how it answers, and what goes wrong."""

    corrections: Callable[[int], bytes] = empty_corrections
    """what is sent in epoch 0, 1, ..."""
    interval: float = 1.0
    """between epochs, s"""
    mount: str = "MP1"
    """name of the mount point"""
    login: str = ""
    """`user:password` that it asks for; empty: none"""
    dialect: Dialect = Dialect.V2_CHUNKED
    fault: CasterFault = CasterFault.NONE
    after: int = 3
    """good epochs before it goes wrong"""
    needs_position: bool = False
    """send nothing before the first GGA, as networks do"""


class Caster:
    """A caster that serves one mount point to any number of clients until `stop`; a context manager does both."""

    def __init__(
        self,
        settings: CasterSettings,
        *,
        tls: ssl.SSLContext | None = None,
        address: tuple[str, int] = ("127.0.0.1", 0),
    ) -> None:
        """Prepare.

        Args:
            settings: what it serves.
            tls: the server's context; None: not encrypted.
            address: where to listen; port 0: any free one.
        """
        self._settings, self._tls, self._address = settings, tls, address
        self.requests: deque[bytes] = deque(maxlen=100)
        self.positions: deque[bytes] = deque(maxlen=100)
        """GGA lines that clients uploaded after their request"""
        self.port = 0
        self._stopped = threading.Event()
        self._acceptor: threading.Thread | None = None
        self._servants: list[threading.Thread] = []

    def start(self) -> int:
        """Listen, and return the port."""
        server = socket.create_server(self._address)
        server.settimeout(0.1)
        self.port = int(server.getsockname()[1])
        self._stopped.clear()
        self._acceptor = threading.Thread(target=self._accept, args=(server,), name="caster", daemon=True)
        self._acceptor.start()
        return self.port

    def stop(self) -> None:
        """Leave all clients."""
        self._stopped.set()
        if self._acceptor:
            self._acceptor.join()
        for servant in self._servants:
            servant.join()

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def _accept(self, server: socket.socket) -> None:
        with server:
            while not self._stopped.is_set():
                with suppress(TimeoutError):
                    client = server.accept()[0]
                    servant = threading.Thread(target=self._serve, args=(client,), name="caster", daemon=True)
                    servant.start()
                    self._servants = [each for each in self._servants if each.is_alive()] + [servant]

    def _serve(self, plain: socket.socket) -> None:
        """Answer one client until it or the caster leaves."""
        plain.settimeout(IDLE)
        with suppress(OSError), self._tls.wrap_socket(plain, server_side=True) if self._tls else plain as client:
            request, rest = self._read_request(client)
            self.requests.append(request)
            head, streams = self._answer(request)
            client.sendall(head)
            if streams:
                self._stream(client, has_position=self._note(rest) or b"Ntrip-GGA:" in request)

    def _read_request(self, client: socket.socket) -> tuple[bytes, bytes]:
        data = b""
        while b"\r\n\r\n" not in data and len(data) < LONGEST_REQUEST:
            piece = client.recv(1024)
            if not piece:
                raise ConnectionResetError
            data += piece
        request, end, rest = data.partition(b"\r\n\r\n")
        return request + end, rest

    def _answer(self, request: bytes) -> tuple[bytes, bool]:
        """Return the head of the reply, and whether a stream follows."""
        settings = self._settings
        login = base64.b64encode(settings.login.encode())
        known = not settings.login or b"Authorization: Basic " + login in request.split(b"\r\n")
        if settings.fault is CasterFault.UNAUTHORIZED or not known:
            return b"HTTP/1.1 401 Unauthorized\r\n\r\n", False
        if settings.fault is CasterFault.NOT_FOUND:
            return b"HTTP/1.1 404 Not Found\r\n\r\n", False
        if request.split(b" ")[1:2] != [f"/{settings.mount}".encode()]:
            return self._source_table(), False
        return _HEADS[settings.dialect], True

    def _source_table(self) -> bytes:
        mount, needs_position = self._settings.mount, int(self._settings.needs_position)
        row = f"STR;{mount};;RTCM 3.2;1005(10),1077(1);2;GPS;;;0.00;0.00;{needs_position};0;;none;B;N;;"
        table = f"{row}\r\nENDSOURCETABLE\r\n".encode()
        if self._settings.dialect in (Dialect.V1, Dialect.V1_ONE_LINE_END):
            return b"SOURCETABLE 200 OK\r\nContent-Type: text/plain\r\n\r\n" + table
        head = "HTTP/1.1 200 OK\r\nNtrip-Version: Ntrip/2.0\r\nContent-Type: gnss/sourcetable\r\nConnection: close"
        return f"{head}\r\nContent-Length: {len(table)}\r\n\r\n".encode() + table

    def _stream(self, client: socket.socket, has_position: bool) -> None:
        settings, noise, epoch = self._settings, Random(0), 0
        while not self._stopped.is_set():
            has_position = self._note(_arrived(client)) or has_position
            broken = epoch >= settings.after and settings.fault is not CasterFault.NONE
            if broken and settings.fault is CasterFault.CLOSE:
                return
            if broken and settings.fault is CasterFault.RESET:
                client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                return
            if has_position or not settings.needs_position:
                client.sendall(self._coded(self._bytes_of(epoch, broken, noise)))
                epoch += 1
            self._stopped.wait(settings.interval)

    def _bytes_of(self, epoch: int, broken: bool, noise: Random) -> bytes:
        settings = self._settings
        if broken and settings.fault is CasterFault.STALL:
            return b""
        if broken and settings.fault is CasterFault.DRIP:
            whole = settings.corrections(settings.after)
            return whole[(epoch - settings.after) % len(whole) :][:1]
        return noise.randbytes(100) if broken else settings.corrections(epoch)

    def _coded(self, data: bytes) -> bytes:
        """Return the bytes as the dialect sends them, chunks cut inside frames."""
        if self._settings.dialect is not Dialect.V2_CHUNKED:
            return data
        cut = len(data) // 3
        return b"".join(b"%x\r\n%b\r\n" % (len(piece), piece) for piece in (data[:cut], data[cut:]) if piece)

    def _note(self, upload: bytes) -> bool:
        """Keep the positions that a client sent, and return whether there are any."""
        found = [line for line in upload.splitlines() if line.startswith(b"$GPGGA,")]
        self.positions.extend(found)
        return bool(found)


_HEADS = {
    Dialect.V1: b"ICY 200 OK\r\n\r\n",
    Dialect.V1_ONE_LINE_END: b"ICY 200 OK\r\n",
    Dialect.V2_PLAIN: b"HTTP/1.1 200 OK\r\nNtrip-Version: Ntrip/2.0\r\nContent-Type: gnss/data\r\n"
    b"Connection: close\r\n\r\n",
    Dialect.V2_CHUNKED: b"HTTP/1.1 200 OK\r\nNtrip-Version: Ntrip/2.0\r\nContent-Type: gnss/data\r\n"
    b"Transfer-Encoding: chunked\r\nConnection: close\r\n\r\n",
}


def _arrived(client: socket.socket) -> bytes:
    """Return what a client has sent; ConnectionResetError: it is gone."""
    pending = isinstance(client, ssl.SSLSocket) and client.pending()
    if not pending and not select.select([client], [], [], 0.0)[0]:
        return b""
    data = client.recv(4096)
    if not data:
        raise ConnectionResetError
    return data
