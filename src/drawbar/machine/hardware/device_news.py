"""News of receivers and sensor board while they are driven with, in words for the operator, each reported once."""

from collections import deque
from collections.abc import Iterator

from drawbar.machine.hardware.receiver import Receiver
from drawbar.protocols.gnss.assembly import SPOOFED
from drawbar.protocols.gnss.checks import too_slow
from drawbar.transports.base import Transport

_STEPS = 10
"""between epochs, of which the second shortest tells the rate: the others may be gaps, and one a wrong time"""


class LineNews:
    """Whether a device's line is lost, and why."""

    def __init__(self, name: str, transport: Transport) -> None:
        """Take the device's name for the operator, and its transport."""
        self._name, self._transport, self._lost = name, transport, False

    def update(self) -> Iterator[str]:
        """Yield what is new."""
        line = self._transport
        if line.connected == self._lost and (line.connected or line.trouble):
            self._lost = not line.connected
            yield f"{self._name}: {line.trouble if self._lost else 'it is connected again'}"


class ReceiverNews:
    """Whether a receiver reports spoofing, and whether it sends too few epochs."""

    def __init__(self, name: str, receiver: Receiver, sample_time: float) -> None:
        """Take the receiver, its name for the operator, and the controller's sample time, s."""
        self._name, self._receiver, self._sample_time = name, receiver, sample_time
        self._steps = deque[float](maxlen=_STEPS)
        self._last, self._slow, self._spoofed = receiver.last, "", False

    def update(self) -> Iterator[str]:
        """Yield what is new."""
        before, self._last = self._last, self._receiver.last
        if self._last is None or before is self._last:
            return
        if not self._spoofed and self._receiver.dropped[SPOOFED]:
            self._spoofed = True
            yield f"{self._name}: it reports false satellite signals (spoofing), and counts as without a fix"
        if before is not None:
            self._steps.append(self._last.time - before.time)
        if len(self._steps) == _STEPS:
            slow, self._slow = self._slow, too_slow(1.0 / sorted(self._steps)[1], self._sample_time)
            if self._slow and not slow:
                yield f"{self._name}: {self._slow}"
