"""Simulated links between the parts of a rehearsal; they carry bytes, and faults can be put into each."""

import heapq
import itertools
from collections.abc import Callable, Iterable

LinkFault = Callable[[float, bytes], Iterable[tuple[float, bytes]]]
"""what becomes of bytes on their way, given the time (s): each of those that arrive, with its delay (s)"""


class SimulatedLinks:
    """Carries bytes from part to part: at once, or as the fault of their link has it."""

    def __init__(self) -> None:
        """Begin without faults."""
        self.faults: dict[str, LinkFault] = {}
        """by the names of the links"""
        self._under_way: list[tuple[float, int, Callable[[bytes], None], bytes]] = []
        self._sent = itertools.count()

    def send(self, time: float, name: str, data: bytes, receive: Callable[[bytes], None]) -> None:
        """Carry bytes over the link of a name to who receives them."""
        fault = self.faults.get(name)
        for delay, each in fault(time, data) if fault else ((0.0, data),):
            if delay > 0.0:
                heapq.heappush(self._under_way, (time + delay, next(self._sent), receive, each))
            else:
                receive(each)

    def deliver(self, time: float) -> None:
        """Let arrive what is due."""
        while self._under_way and self._under_way[0][0] <= time:
            _, _, receive, data = heapq.heappop(self._under_way)
            receive(data)
