"""A bus of python-can behind `CanBus`, and two ends of one for a test; only as much as tests need."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from drawbar.transports.base import CanBus, CanFrame


class PythonCanBus(CanBus):
    """One end of a bus of python-can; stamps frames when they are read.

    On udp_multicast a sender hears itself (python-can 4.6): `echoes` leaves out what this end has sent.
    """

    connected = True

    def __init__(self, bus: Any, echoes: bool) -> None:
        self.bus, self.echoes = bus, echoes
        self.own: list[CanFrame] = []

    def fileno(self) -> int:
        return -1

    def read(self) -> list[tuple[float, CanFrame]]:
        frames = []
        while (message := self.bus.recv(timeout=0.0)) is not None:
            frame = CanFrame(message.arbitration_id, bytes(message.data))
            if frame in self.own:
                self.own.remove(frame)
            else:
                frames.append((time.monotonic(), frame))
        return frames

    def write(self, frame: CanFrame) -> bool:
        import can

        self.own += [frame] if self.echoes else []
        self.bus.send(can.Message(arbitration_id=frame.identifier, data=frame.data, is_extended_id=True))
        return True

    def close(self) -> None:
        self.bus.shutdown()


class Wire:
    """Ends of one bus without python-can and without time: what one end writes, all others read."""

    def __init__(self) -> None:
        self.time = 0.0
        self.cut = False
        self.ends: list[WireEnd] = []
        self.seen: list[tuple[float, CanFrame]] = []

    def end(self) -> "WireEnd":
        self.ends.append(WireEnd(self))
        return self.ends[-1]


class WireEnd(CanBus):
    """One end of a `Wire`."""

    connected = True

    def __init__(self, wire: Wire) -> None:
        self.wire = wire
        self.inbox: list[tuple[float, CanFrame]] = []

    def fileno(self) -> int:
        return -1

    def read(self) -> list[tuple[float, CanFrame]]:
        frames, self.inbox = self.inbox, []
        return frames

    def write(self, frame: CanFrame) -> bool:
        self.wire.seen.append((self.wire.time, frame))
        for end in self.wire.ends:
            if end is not self and not self.wire.cut:
                end.inbox.append((self.wire.time, frame))
        return not self.wire.cut

    def close(self) -> None:
        pass


@contextmanager
def two_ends(make: Callable[[], Any], *, echoes: bool = False) -> Iterator[tuple[PythonCanBus, PythonCanBus]]:
    """Give two ends of one bus of python-can, and close them."""
    ends = [PythonCanBus(make(), echoes), PythonCanBus(make(), echoes)]
    try:
        yield ends[0], ends[1]
    finally:
        for end in ends:
            end.close()
