"""Interrupts at the keyboard (and SIGTERM) while a run is driven and reported: heeded between two steps, never within.

The first one asks; the loop ends after its step, and the report is made. Where nothing heeds it for a while, because
the machine does not answer or the report takes long, the next one raises KeyboardInterrupt at once. Hitting the keys
many times does no harm.
"""

import signal
import time
from types import FrameType, TracebackType
from typing import Self

_PATIENCE = 2.0
"""s that an interrupt may wait to be heeded before another one raises"""


class Interrupts:
    """As a context: takes over the signals, and gives them back."""

    def __init__(self) -> None:
        """Nobody has asked yet."""
        self._asked: float | None = None

    def heed(self) -> None:
        """Raise KeyboardInterrupt if somebody has asked since the last call."""
        if self._asked is not None:
            self._asked = None
            raise KeyboardInterrupt

    def _ask(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if self._asked is not None and now - self._asked >= _PATIENCE:
            raise KeyboardInterrupt
        if self._asked is None:
            self._asked = now

    def __enter__(self) -> Self:
        self._before = {each: signal.signal(each, self._ask) for each in (signal.SIGINT, signal.SIGTERM)}
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for each, handler in self._before.items():
            signal.signal(each, handler)
