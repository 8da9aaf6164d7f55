"""TLS between plain bytes and those on the wire, apart from any socket: the client's side."""

import ssl
from contextlib import suppress

MOST = 65536
"""sealed bytes that may wait for the socket; more: the other end does not take them"""


class TlsLayer:
    """One TLS session. What it wants sent is in `sealed()`; `sent()` takes how much of that went."""

    def __init__(self, context: ssl.SSLContext, host: str) -> None:
        self._from_wire, self._to_wire = ssl.MemoryBIO(), ssl.MemoryBIO()
        self._session = context.wrap_bio(self._from_wire, self._to_wire, server_hostname=host)
        self._sealed = b""

    @property
    def stuck(self) -> bool:
        """Whether more bytes wait for the socket than it can be expected to take."""
        return len(self._sealed) > MOST

    def agree(self, data: bytes) -> bool:
        """Go on with the handshake after `data` came, and return whether it is done; ssl.SSLError: it failed."""
        self._from_wire.write(data)
        try:
            self._session.do_handshake()
        except ssl.SSLWantReadError:
            return False
        return True

    def opened(self, data: bytes) -> bytes:
        """Return the plain bytes that `data` completes; ssl.SSLError: it is not what the other end sealed."""
        self._from_wire.write(data)
        plain = bytearray()
        # both errors mean that this is all there is; an announced end is followed by the socket's own
        with suppress(ssl.SSLWantReadError, ssl.SSLZeroReturnError):
            while piece := self._session.read(16384):
                plain += piece
        return bytes(plain)

    def seal(self, data: bytes) -> None:
        """Put plain bytes into `sealed()`."""
        self._session.write(data)

    def sealed(self) -> bytes:
        """Return what is to be sent."""
        self._sealed += self._to_wire.read()
        return self._sealed

    def sent(self, count: int) -> None:
        """Forget what was sent."""
        self._sealed = self._sealed[count:]
