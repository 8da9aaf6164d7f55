"""CAN devices: stand-ins on one end of a CAN bus, driven by a clock."""

import time
from collections import Counter
from collections.abc import Callable, Sequence

from drawbar.protocols.isobus.node import IsobusNode
from drawbar.transports.base import CanBus


class CanDevices:
    """Nodes that share one end of a bus: they receive what comes over it, and from one another."""

    def __init__(self, bus: CanBus, nodes: Sequence[IsobusNode]) -> None:
        self.dropped: Counter[str] = Counter()
        self._bus, self._nodes = bus, nodes

    def step(self, now: float) -> None:
        """Take in what has come, and send what is due at `now`, monotonic, s."""
        for received, frame in self._bus.read():
            for node in self._nodes:
                node.receive(received, frame)
        for node in self._nodes:
            for frame in node.send(now):
                if not self._bus.write(frame):
                    self.dropped["not sent"] += 1
                for other in self._nodes:
                    if other is not node:
                        other.receive(now, frame)

    def run(self, done: Callable[[], bool], tick: float = 0.01) -> None:
        """Step every `tick` s in real time until `done`; ticks that are missed are left out."""
        due = time.monotonic()
        while not done():
            self.step(time.monotonic())
            due = max(due + tick, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))
