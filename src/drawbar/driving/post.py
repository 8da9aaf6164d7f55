"""Post: carries bytes between the parts of a rehearsal, and lets faults be put in on their way."""

import heapq
import itertools
from collections.abc import Callable, Iterable

Tap = Callable[[float, bytes], Iterable[tuple[float, bytes]]]
"""what becomes of bytes on their way, given the time (s): each of those that arrive, with its delay (s)"""


class Post:
    """Carries bytes from part to part: at once, or as the tap on their way has it."""

    def __init__(self) -> None:
        """Begin without taps."""
        self.taps: dict[str, Tap] = {}
        """by the name of what is carried"""
        self._under_way: list[tuple[float, int, Callable[[bytes], None], bytes]] = []
        self._posted = itertools.count()

    def send(self, time: float, name: str, data: bytes, receive: Callable[[bytes], None]) -> None:
        """Carry bytes under a name to who receives them."""
        tap = self.taps.get(name)
        for delay, each in tap(time, data) if tap else ((0.0, data),):
            if delay > 0.0:
                heapq.heappush(self._under_way, (time + delay, next(self._posted), receive, each))
            else:
                receive(each)

    def deliver(self, time: float) -> None:
        """Let arrive what is due."""
        while self._under_way and self._under_way[0][0] <= time:
            _, _, receive, data = heapq.heappop(self._under_way)
            receive(data)
