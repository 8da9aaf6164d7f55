"""Allowances: how many requests one client may still make, and each of many clients. Pure: time is given."""

from collections import OrderedDict
from dataclasses import dataclass, field

_MOST = 256
"""that are remembered; the least recently active is forgotten first"""


@dataclass(slots=True)
class Allowance:
    """How much one may still ask for: `rate` more each second, at most `burst`."""

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


class Allowances:
    """One allowance for each of many."""

    def __init__(self, rate: float, burst: float) -> None:
        """Take what each is allowed."""
        self._rate, self._burst = rate, burst
        self._known: OrderedDict[str, Allowance] = OrderedDict()

    def take(self, who: str, time: float) -> bool:
        """Return whether one more is allowed to somebody at a time, s."""
        allowance = self._known.setdefault(who, Allowance(self._rate, self._burst))
        self._known.move_to_end(who)
        if len(self._known) > _MOST:
            self._known.popitem(last=False)
        return allowance.take(time)
