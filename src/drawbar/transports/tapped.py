"""Tapped transport or CAN bus: every byte that goes in or out, with its stamp, for a run's log."""

import time
from collections.abc import Callable
from dataclasses import replace
from enum import Enum

from drawbar.nanoseconds import nanoseconds, seconds
from drawbar.transports.base import Received, Transport
from drawbar.transports.clock import Clock


class Direction(Enum):
    """Which way bytes went."""

    IN = "in"
    OUT = "out"
    UNSENT = "unsent"
    """given to `write`, which did not take all of it"""


DIRECTIONS = tuple(Direction)
"""by the number that stands for each in a message or a log"""


class TappedTransport(Transport):
    """A transport that hands a copy of everything to a callback, which must not wait.

    Stamps are in whole nanoseconds, as they are recorded, so that a replay goes by the very same.
    """

    def __init__(
        self, inner: Transport, tap: Callable[[Direction, Received], None], clock: Clock = time.monotonic
    ) -> None:
        self._inner, self._tap, self._clock = inner, tap, clock
        self._follow()

    def fileno(self) -> int:
        """Return the transport's descriptor."""
        return self._inner.fileno()

    def read(self) -> list[Received]:
        """Return what has arrived."""
        pieces = [replace(piece, time=seconds(nanoseconds(piece.time))) for piece in self._inner.read()]
        self._follow()
        for piece in pieces:
            self._tap(Direction.IN, piece)
        return pieces

    def write(self, data: bytes) -> bool:
        """Send now, and return whether all of it was taken."""
        moment = self._clock()
        taken = self._inner.write(data)
        self._follow()
        self._tap(Direction.OUT if taken else Direction.UNSENT, Received(moment, data))
        return taken

    def close(self) -> None:
        """Close the transport."""
        self._inner.close()
        self._follow()

    def _follow(self) -> None:
        self.connected, self.trouble, self.unsent = self._inner.connected, self._inner.trouble, self._inner.unsent
