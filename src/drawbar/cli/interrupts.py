"""Interrupts at the keyboard, SIGTERM and SIGHUP during a drive: handled between two steps, never within one.

The first one is noted; the loop ends after its step, and the report is made. Where it is not handled for a while,
because the machine does not answer or the report takes long, the next one raises KeyboardInterrupt at once. Hitting the
keys many times does no harm.
"""

import errno
import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Self

_PATIENCE = 2.0
"""after which a noted interrupt is late and another one raises, s"""
_HANG_UP = getattr(signal, "SIGHUP", None)
"""which Windows does not have"""


class Interrupts:
    """As a context: takes over the signals, and gives them back."""

    def __init__(self) -> None:
        """Nobody has asked yet."""
        self._asked: float | None = None

    def raise_pending(self) -> None:
        """Raise KeyboardInterrupt if somebody has asked since the last call."""
        if self._asked is not None:
            self._asked = None
            raise KeyboardInterrupt

    def _ask(self, number: int, frame: FrameType | None) -> None:
        if number == _HANG_UP:
            leave_a_terminal_that_is_gone()
        now = time.monotonic()
        if self._asked is not None and now - self._asked >= _PATIENCE:
            raise KeyboardInterrupt
        if self._asked is None:
            self._asked = now

    def __enter__(self) -> Self:
        taken = [signal.SIGINT, signal.SIGTERM]
        if _HANG_UP is not None and signal.getsignal(_HANG_UP) is not signal.SIG_IGN:  # as nohup has it
            taken.append(_HANG_UP)
        self._before = {each: signal.signal(each, self._ask) for each in taken}
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for each, handler in self._before.items():
            signal.signal(each, handler)


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end what moves something as Ctrl-C does, in order; later ones are ignored."""
    taken = [signal.SIGINT, signal.SIGTERM, *([_HANG_UP] if _HANG_UP is not None else [])]

    def end(number: int, frame: FrameType | None) -> None:
        for each in taken:
            signal.signal(each, signal.SIG_IGN)
        if number == _HANG_UP:
            leave_a_terminal_that_is_gone()
        raise KeyboardInterrupt

    before = {each: signal.getsignal(each) for each in taken}
    try:
        for each in taken:
            if before[each] is not signal.SIG_IGN:  # as nohup has it
                signal.signal(each, end)
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)


def leave_a_terminal_that_is_gone() -> bool:
    """Let what is printed from now on go nowhere where the terminal is gone: it would raise amid an orderly end.

    Returns:
        Whether it is gone.
    """
    gone = False
    for stream in (sys.stdout, sys.stderr):
        try:
            os.get_terminal_size(stream.fileno())
        except OSError as error:
            if error.errno == errno.EIO:
                gone = True
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    return gone
