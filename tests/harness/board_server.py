"""Board server: a stand-in board on a UDP socket of this computer."""

import select
import socket
import threading
import time
from collections.abc import Callable

from drawbar.errors import HardwareError
from drawbar.machine.stand_in.board import Output, StandInBoard

_DATAGRAMS = 256
"""taken in one poll at most, so that a flood does not stop the board's clock"""


class BoardServer:
    """Joins a board and a socket. `poll` does what is due and never waits; `run` waits in between."""

    def __init__(
        self,
        board: StandInBoard,
        *,
        host: str = "127.0.0.1",
        port: int = 8888,
        computer: tuple[str, int] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Bind the socket.

        Args:
            board: started at a time of `clock`.
            host: address to listen on; 127.0.5.126 and 127.0.6.126 stand for two boards on two networks.
            port: to listen on; 0 takes a free one.
            computer: where it sends; None: to the last one it heard from, as boards' broadcasts do not reach loopback.
            clock: s; the board's own time.

        Raises:
            HardwareError: the address is not free.
        """
        self.board = board
        self._clock, self._fixed, self._computer = clock, computer, computer
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            raise HardwareError(
                f"the stand-in board cannot listen on {host}:{port} ({error.strerror}); "
                "end the program that does, or give another address"
            ) from None

    @property
    def address(self) -> tuple[str, int]:
        """Host and port it listens on."""
        host, port = self._socket.getsockname()
        return host, port

    def fileno(self) -> int:
        """Return the descriptor to wait on."""
        return self._socket.fileno()

    def poll(self) -> None:
        """Take in what has arrived, do the ticks due, and send what they give."""
        for _ in range(_DATAGRAMS):
            try:
                datagram, sender = self._socket.recvfrom(2048)
            except BlockingIOError:
                break
            self._computer = self._fixed or sender
            self._transmit(self.board.receive(self._clock(), datagram, sender[1]))
        self._transmit(self.board.advance(self._clock()))

    def _transmit(self, outputs: list[Output]) -> None:
        if self._computer is None:
            return
        for output in outputs:
            try:
                self._socket.sendto(output.data, self._computer)
            except OSError:  # nobody there, or no room: lost, as on a wire
                continue

    def run(self, stop: threading.Event) -> None:
        """Poll until `stop` is set, waiting between ticks."""
        while not stop.is_set():
            wait = max(self.board.next_tick - self._clock(), 0.0)
            select.select([self._socket], [], [], min(wait, self.board.TICK))
            self.poll()

    def close(self) -> None:
        """Give the socket back."""
        self._socket.close()
