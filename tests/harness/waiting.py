"""Waiting for sockets and ptys in tests: look again until it is so, or fail after a while."""

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
