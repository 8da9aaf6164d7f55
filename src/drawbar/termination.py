"""Termination: SIGTERM as an exception, so that what must be done at last is done."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def termination_as_exit() -> Iterator[None]:
    """Let SIGTERM raise SystemExit within the context, unless the program has a handler of its own.

    Signals are the main thread's: in another one nothing changes.
    """
    handles = _is_main() and signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    if handles:
        signal.signal(signal.SIGTERM, _exit)
    try:
        yield
    finally:
        if handles and signal.getsignal(signal.SIGTERM) is _exit:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _is_main() -> bool:
    return threading.current_thread() is threading.main_thread()


def _exit(number: int, frame: FrameType | None) -> None:
    raise SystemExit(128 + number)
