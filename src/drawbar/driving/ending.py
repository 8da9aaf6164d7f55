"""Ending: a process is told to end by SIGTERM or SIGINT, and ends at its next look."""

import signal
from types import FrameType


class Ending:
    """Whether this process has been told to end."""

    def __init__(self) -> None:
        """Take over both signals."""
        self.asked = False
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._ask)

    def _ask(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
