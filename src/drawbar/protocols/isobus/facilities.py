"""Facilities: which messages of the machine are there, when one is lost and when it comes back."""

import math
from collections import Counter, deque
from dataclasses import dataclass

_CHANGES = 64
"""changes kept until they are asked for; older ones are dropped and counted"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FacilityChange:
    """One facility came, was lost or came back."""

    name: str
    present: bool
    time: float
    """of the first message, or of the last one before the silence, monotonic, s"""


class Facilities:
    """The facilities of one machine, each lost after `timeout`, s, without a message; at 10 Hz three are missed."""

    def __init__(self, *names: str, timeout: float = 0.3) -> None:
        self.dropped: Counter[str] = Counter()
        self.losses: Counter[str] = Counter()
        """how often each was lost"""
        self._timeout = timeout
        self._times = dict.fromkeys(names, -math.inf)
        self._present = dict.fromkeys(names, False)
        self._changes: deque[FacilityChange] = deque(maxlen=_CHANGES)

    def received(self, name: str, time: float) -> None:
        """Note a message of a facility."""
        self._expire(name, time)
        if not self._present[name]:
            self._change(name, True, time)
        self._times[name] = time

    def present(self, name: str, time: float) -> bool:
        """Return whether the facility is there now."""
        return time - self._times[name] <= self._timeout

    def changes(self, time: float) -> list[FacilityChange]:
        """Return what came and went since the last call, in the order in which it was noticed."""
        for name in self._times:
            self._expire(name, time)
        changes = list(self._changes)
        self._changes.clear()
        return changes

    def _expire(self, name: str, time: float) -> None:
        if self._present[name] and not self.present(name, time):
            self.losses[name] += 1
            self._change(name, False, self._times[name])

    def _change(self, name: str, present: bool, time: float) -> None:
        self._present[name] = present
        if len(self._changes) == _CHANGES:
            self.dropped["facility change"] += 1
        self._changes.append(FacilityChange(name=name, present=present, time=time))
