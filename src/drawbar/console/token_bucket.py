"""Token bucket: limits how many requests a client may make. Pure: time is given."""

from collections import OrderedDict
from dataclasses import dataclass, field

_MOST = 256
"""that are remembered; the least recently active is forgotten first"""


@dataclass(slots=True)
class TokenBucket:
    """How many requests are left: `rate` more each second, at most `burst`."""

    rate: float
    burst: float
    left: float = field(default=0.0)
    since: float = field(default=float("-inf"))

    def take(self, time: float) -> bool:
        """Return whether one more is allowed at a time, s."""
        if self.since == float("-inf"):
            self.left = self.burst
        else:
            self.left = min(self.burst, self.left + self.rate * (time - self.since))
        self.since = time
        if self.left < 1.0:
            return False
        self.left -= 1.0
        return True


class TokenBuckets:
    """One bucket for each client."""

    def __init__(self, rate: float, burst: float) -> None:
        """Take rate (1/s) and burst of each bucket."""
        self._rate, self._burst = rate, burst
        self._known: OrderedDict[str, TokenBucket] = OrderedDict()

    def take(self, who: str, time: float) -> bool:
        """Return whether one more is allowed to somebody at a time, s."""
        bucket = self._known.setdefault(who, TokenBucket(self._rate, self._burst))
        self._known.move_to_end(who)
        if len(self._known) > _MOST:
            self._known.popitem(last=False)
        return bucket.take(time)
