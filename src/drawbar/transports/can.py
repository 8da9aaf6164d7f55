"""CAN buses through python-can: data frames with 29-bit identifiers; all else is dropped and counted by kind."""

import contextlib
import time
from collections import Counter, deque
from typing import TYPE_CHECKING, Any

from drawbar.transports.address import CanAddress
from drawbar.transports.base import CanBus, CanFrame
from drawbar.transports.clock import Clock, StampConverter

if TYPE_CHECKING:
    import can

RETRY = 1.0
"""between attempts to open the bus, s"""
BIT_RATE = 250_000
"""of ISO 11783 and NMEA 2000; socketcan's is set where its interface is brought up, bit/s"""
ECHO = 1.0
"""a frame of our own comes back on udp_multicast before this time, or was lost, s"""
AT_ONCE = 1000
"""frames that one call of `read` takes at most"""


class PythonCanBus(CanBus):
    """A bus of python-can.

    slcan waits for its serial line to drain at each frame, some milliseconds: for trials, not for steering.
    """

    def __init__(self, address: CanAddress, clock: Clock = time.monotonic, wall_clock: Clock = time.time) -> None:
        self.address = address
        self.connected = False
        self.dropped: Counter[str] = Counter()
        """what came and is no data frame with a 29-bit identifier, by kind"""
        self._clock = clock
        self._stamps = StampConverter(clock, wall_clock)
        self._bus: can.BusABC | None = None
        self._echoes: deque[tuple[float, CanFrame]] = deque(maxlen=AT_ONCE)
        """what udp_multicast was given, with when, s: it comes back, as on no other bus"""
        self._opened = clock()
        self._open()

    def fileno(self) -> int:
        """Return the descriptor to wait on, -1 where there is none."""
        try:
            return self._bus.fileno() if self._bus else -1
        except NotImplementedError:
            return -1

    def read(self) -> list[tuple[float, CanFrame]]:
        """Return the frames that have arrived; open the bus again when it is time."""
        now = self._clock()
        if self._bus is None and now - self._opened >= RETRY:
            self._opened = now
            self._open()
        frames: list[tuple[float, CanFrame]] = []
        for _ in range(AT_ONCE):
            message = self._receive()
            if message is None:
                break
            kind = _foreign(message)
            if kind:
                self.dropped[kind] += 1
            else:
                moment = self._stamps.monotonic(message.timestamp)
                frame = CanFrame(message.arbitration_id, bytes(message.data))
                if not self._is_echo(frame):
                    frames.append((moment, frame))
        return frames

    def write(self, frame: CanFrame) -> bool:
        """Send now, and return whether it was taken."""
        import can

        taken = False
        if self._bus:
            try:
                self._bus.send(can.Message(arbitration_id=frame.identifier, data=frame.data, is_extended_id=True))
                taken = True
                if self.address.interface == "udp_multicast":
                    self._echoes.append((self._clock(), frame))
            except (can.CanError, OSError) as error:
                self.trouble = f"{self._name} took no frame: {error}"
        self.unsent += not taken
        return taken

    def close(self) -> None:
        """Give the bus back."""
        self.connected = False
        bus, self._bus = self._bus, None
        if bus:
            with contextlib.suppress(Exception):  # a bus whose device is gone cannot be shut down
                bus.shutdown()

    @property
    def _name(self) -> str:
        return f"{self.address.interface} {self.address.channel}"

    def _open(self) -> None:
        import can

        try:
            self._bus = can.Bus(interface=self.address.interface, channel=self.address.channel, **self._options())
        except Exception as error:  # also termios.error, of a serial line that goes meanwhile
            self.trouble = f"{self._name} cannot be opened: {error}"
            return
        self.connected, self.trouble = True, ""

    def _options(self) -> dict[str, Any]:
        if self.address.interface == "slcan":
            return {"tty_baudrate": self.address.number, "bitrate": BIT_RATE, "sleep_after_open": 0, "timeout": 0}
        if self.address.interface == "udp_multicast":
            return {"port": self.address.number, "hop_limit": 0, "fd": False}
        return {}

    def _receive(self) -> "can.Message | None":
        """Return the next message; garbage on the way is counted, a device that is gone ends the connection."""
        import can

        for _ in range(AT_ONCE):
            try:
                return self._bus.recv(timeout=0) if self._bus else None
            except (can.CanError, OSError, ValueError, IndexError) as error:
                self._judge(error)
        return None

    def _judge(self, error: Exception) -> None:
        """Decide whether the device is gone, or some bytes were no frame."""
        cause = error.__cause__ or error
        if isinstance(cause, OSError):
            self._lose(str(error))
            return
        self.dropped["garbage"] += 1
        if isinstance(cause, UnicodeDecodeError) and self._bus:
            self._bus.flush()  # type: ignore[attr-defined]  # slcan would keep a line that is not text for ever

    def _is_echo(self, frame: CanFrame) -> bool:
        """Return whether it is a frame of our own: all nodes of a multicast group send from one address and port."""
        while self._echoes and self._clock() - self._echoes[0][0] > ECHO:
            self._echoes.popleft()
        for position, (_, own) in enumerate(self._echoes):
            if own == frame:
                del self._echoes[position]
                return True
        return False

    def _lose(self, reason: str) -> None:
        self.close()
        self.trouble = f"{self._name} is lost: {reason}"
        self._opened = self._clock()


def _foreign(message: "can.Message") -> str:
    """Return what a message is instead of a data frame with a 29-bit identifier, or nothing."""
    if message.is_error_frame:
        return "error frame"
    if message.is_remote_frame:
        return "remote frame"
    if message.is_fd:
        return "CAN FD frame"
    return "" if message.is_extended_id else "11-bit identifier"
