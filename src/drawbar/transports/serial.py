"""Serial lines through pyserial, 8N1, opened for this program alone; an unplugged one is opened again by itself."""

import contextlib
import errno
import os
import select
import time
from typing import Any

from drawbar.transports.address import SerialAddress
from drawbar.transports.base import Received, Transport
from drawbar.transports.clock import Clock

RETRY = 1.0
"""between attempts to open the device, s"""
LEAVING = 0.1
"""for which a line that is closed is waited for until it has sent what it was given, s; the rest is dropped"""
_LOOK = 0.001
"""between two looks at what still waits, s"""
PIECE = 65536


class SerialTransport(Transport):
    """A serial line. It reads and writes the descriptor itself: pyserial's `write` spins while the line is busy."""

    def __init__(self, address: SerialAddress, clock: Clock = time.monotonic) -> None:
        self.address = address
        self.connected = False
        self.low_latency = False
        """the driver has promised to hand over bytes at once; USB adapters otherwise collect them for up to 16 ms"""
        self._clock = clock
        self._port: Any = None
        self._opened = clock()
        self._open()

    def fileno(self) -> int:
        """Return the descriptor to wait on, -1 while there is none."""
        return int(self._port.fileno()) if self._port else -1

    def read(self) -> list[Received]:
        """Return what has arrived, as one piece; open the device again when it is time."""
        now = self._clock()
        if self._port is None and now - self._opened >= RETRY:
            self._opened = now
            self._open()
        data = self._take() if self._port else b""
        return [Received(now, data)] if data else []

    def write(self, data: bytes) -> bool:
        """Send now, and return whether all of it was taken."""
        taken = 0
        if self._port:
            try:
                with contextlib.suppress(
                    BlockingIOError
                ):  # its buffer is full: nothing is taken, which is reported below
                    taken = os.write(self.fileno(), data)
            except OSError as error:
                self._lose(error.strerror or str(error))
        if self._port and taken < len(data):
            self.trouble = f"{self.address.device} takes no more bytes: more was sent than its baud rate allows"
        self.unsent += len(data) - taken
        return taken == len(data)

    def close(self) -> None:
        """Give the device back. What was sent leaves before, as the last word to an actuator must; see `LEAVING`."""
        if self._port:
            with contextlib.suppress(Exception):  # an unplugged device refuses whatever it is asked
                end = time.monotonic() + LEAVING
                while self._port.out_waiting and time.monotonic() < end:
                    time.sleep(_LOOK)
        self._give_back()

    def _give_back(self) -> None:
        """Give the device back, at once: bytes that wait in the driver are dropped."""
        self.connected = False
        port, self._port = self._port, None
        if port:
            with contextlib.suppress(Exception):
                if port.out_waiting:
                    port.reset_output_buffer()
            with contextlib.suppress(Exception):
                port.close()

    def _open(self) -> None:
        import serial

        try:
            self._port = serial.Serial(
                self.address.device, self.address.baud, timeout=0, write_timeout=0, exclusive=True
            )
        except Exception as error:  # pyserial lets termios.error through, of a device that goes meanwhile
            self.trouble = f"{self.address.device} cannot be opened: {_reason(error, self.address.device)}"
            return
        self.connected, self.trouble = True, ""
        try:
            self._port.set_low_latency_mode(True)
            self.low_latency = True
        except (ValueError, NotImplementedError):  # not every driver supports it
            self.low_latency = False

    def _take(self) -> bytes:
        """Return the bytes that are there; an end of file or a hang-up means that the device is gone."""
        poll = select.poll()
        poll.register(self.fileno(), select.POLLIN)
        events = sum(event for _, event in poll.poll(0))
        data = b""
        try:
            if events & select.POLLIN:
                data = os.read(self.fileno(), PIECE)
        except OSError as error:
            self._lose(error.strerror or str(error))
            return b""
        if events and not data:
            self._lose("it was unplugged")
        return data

    def _lose(self, reason: str) -> None:
        self._give_back()
        self.trouble = f"{self.address.device} is lost: {reason}"
        self._opened = self._clock()


def _reason(error: Exception, device: str) -> str:
    """Return the system's message, without pyserial's words around it."""
    code = getattr(error, "errno", None) or next((each for each in error.args if isinstance(each, int)), None)
    if "exclusively lock" in str(error):
        return "another program has it open; stop that program"
    if "Could not configure port" in str(error):
        return "it is no serial line"
    if code == errno.EACCES:
        return f"you may not open it; add your user to its group (ls -l {device}; often dialout), and log in again"
    return os.strerror(code) if code else str(error)
