"""Flow control: a slow browser is sent fewer pictures, and never draws old ones in a row."""

import math
import time

_MOST = 2
_LOST = 1.0
"""after which a picture that was sent and is not acknowledged counts as lost, s"""


class FlowControl:
    """Counts pictures from when they are sent until the browser acknowledges them."""

    def __init__(self) -> None:
        """Begin with none."""
        self._count, self._sent = 0, -math.inf

    @property
    def may_send(self) -> bool:
        """Whether another one may be sent: not while two are under way, unless they must have been lost."""
        return self._count < _MOST or time.monotonic() - self._sent > _LOST

    def send(self) -> None:
        """Count one that is sent."""
        self._count = min(self._count + 1, _MOST)
        self._sent = time.monotonic()

    def drawn(self) -> None:
        """Take in that the browser has drawn one."""
        self._count = max(0, self._count - 1)
