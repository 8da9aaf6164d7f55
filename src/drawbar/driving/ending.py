"""Ending: a process is told to end by SIGTERM or SIGINT, or whoever started it is gone; it ends at its next look."""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from drawbar.errors import DrawbarError


class Ending:
    """Whether this process is to end."""

    def __init__(self) -> None:
        """Take over both signals."""
        self._told, self._starter = False, os.getppid()
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._tell)

    @property
    def asked(self) -> bool:
        """Whether one of the signals has come, or the process that started this one has ended."""
        return self._told or os.getppid() != self._starter

    def _tell(self, number: int, frame: FrameType | None) -> None:
        self._told = True


@contextmanager
def undisturbed() -> Iterator[None]:
    """Ignore the signals that end a process while it ends already, in order."""
    before = {each: signal.signal(each, signal.SIG_IGN) for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)


def told(main: Callable[[], int]) -> int:
    """Return the exit code of a process's program; an expected error is one message, which the crew passes on."""
    try:
        return main()
    except DrawbarError as error:
        print(error, file=sys.stderr)
        return 2
