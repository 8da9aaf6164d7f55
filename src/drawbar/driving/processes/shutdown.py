"""Shutdown of a process: requested by SIGTERM, SIGINT or the end of its starter; polled by the process's loop."""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from drawbar.errors import DrawbarError

STARTER = "DRAWBAR_STARTER"
"""environment variable with the number of the process that has started this one"""


def starter() -> int:
    """Return the number of the process that has started this one: by STARTER, else the present parent."""
    return int(os.environ.get(STARTER, os.getppid()))


class ShutdownRequest:
    """Whether this process is to end."""

    def __init__(self) -> None:
        """Take over both signals."""
        self._signalled, self._starter = False, starter()
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._tell)

    @property
    def asked(self) -> bool:
        """Whether one of the signals has come, or the process that started this one has ended."""
        return self._signalled or os.getppid() != self._starter

    def _tell(self, number: int, frame: FrameType | None) -> None:
        self._signalled = True


def environment() -> dict[str, str]:
    """Return the environment for a process that is to end with this one, even where this one ends first."""
    return {**os.environ, STARTER: str(os.getpid())}


@contextmanager
def signals_ignored() -> Iterator[None]:
    """Ignore the signals that end a process while it ends already, in order."""
    before = {each: signal.signal(each, signal.SIG_IGN) for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)


def run_program(main: Callable[[], int]) -> int:
    """Run the program of a process and return its exit code; an expected error is one message on standard error."""
    try:
        return main()
    except DrawbarError as error:
        print(error, file=sys.stderr)
        return 2
