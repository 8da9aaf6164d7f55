"""Waiting for sockets and ptys in tests: look again until it is so, or fail after a while."""

import threading
import time
from collections.abc import Callable
from typing import TypeVar

Value = TypeVar("Value")


def until(look: Callable[[], Value], within: float = 60.0) -> Value:
    """Return what `look` returns as soon as that is true; fail after `within` seconds, many on a busy machine."""
    end = time.monotonic() + within
    while True:
        seen = look()
        if seen:
            return seen
        assert time.monotonic() < end, f"not so within {within:g} s"
        time.sleep(0.001)


class FakeClock:
    """A clock that stands still until it is told to move."""

    def __init__(self, now: float = 1000.0) -> None:
        self.now = now

    def __call__(self) -> float:
        return self.now


class PatientClock:
    """A clock of several threads that goes as the monotonic one, but stands still while nobody looks at it.

    So a busy machine, which lets none of them run for a while, makes nothing late by this clock.
    """

    STEP = 0.02
    """longest between two looks, s"""

    def __init__(self) -> None:
        self._seen, self._now, self._lock = time.monotonic(), 1000.0, threading.Lock()

    def __call__(self) -> float:
        with self._lock:
            seen = time.monotonic()
            self._now += min(seen - self._seen, self.STEP)
            self._seen = seen
            return self._now
