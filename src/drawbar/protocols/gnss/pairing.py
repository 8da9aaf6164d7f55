"""Pairing: the epochs of two receivers, one on each body, by their own times."""

from collections import Counter, deque
from dataclasses import dataclass
from enum import Enum

from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.timing import SAME_EPOCH, difference

WAIT = 0.06
"""for the second receiver, after it usually comes, s"""
MOST_BEHIND = 0.5
"""by which one receiver may usually come after the other, s"""
_USUAL = 5
"""pairs, the shortest time between which is the usual one"""
_REMEMBERED = 32
"""epochs of a receiver: more than come in half a second"""
_USUAL_INTERVAL = 0.2
"""of epochs, until it is known, s"""
_LONGEST_INTERVAL = 1.0
"""s; a longer step is a gap"""
_STEPS = 10
"""of a receiver, of which the second shortest is its interval: several may be gaps, and one a wrong time"""


class Body(Enum):
    """Whose antenna it is."""

    TRACTOR = "tractor"
    TRAILER = "trailer"

    @property
    def other(self) -> "Body":
        """The other body."""
        return Body.TRAILER if self is Body.TRACTOR else Body.TRACTOR


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """Epochs of one instant; None: the receiver has none of it."""

    tractor: Epoch | None
    trailer: Epoch | None


@dataclass(frozen=True, slots=True)
class _Held:
    """An epoch that waits for the other receiver's of its instant."""

    body: Body
    epoch: Epoch
    until: float


class Pairing:
    """Holds epochs back until the other receiver's usually come; `dropped` counts those left alone."""

    dropped: Counter[str]

    def __init__(self) -> None:
        self.dropped = Counter()
        self._held: deque[_Held] = deque()  # all of one body
        self._came = {body: deque[tuple[float, float]](maxlen=_REMEMBERED) for body in Body}  # (UTC, when)
        self._behind = {body: deque[float](maxlen=_USUAL) for body in Body}  # after the other's of the instant, s
        self._steps = {body: deque[float](maxlen=_STEPS) for body in Body}

    @property
    def due(self) -> float:
        """Monotonic time at which `poll` has something to do, infinite while there is nothing, s."""
        return self._held[0].until if self._held else float("inf")

    def add(self, body: Body, epoch: Epoch, time: float) -> list[Pair]:
        """Take an epoch that one body's receiver ended at a monotonic time (s); return the pairs that it ends."""
        ended = self.poll(time)
        self._learn(body, epoch, time)
        while self._held and self._held[0].body is not body:
            held = self._held[0]
            after = difference(epoch.utc, held.epoch.utc)
            if abs(after) < self._half_interval():
                self._held.popleft()
                return [*ended, _pair({body: epoch, held.body: held.epoch})]
            if after < 0.0:
                return [*ended, self._alone(body, epoch)]  # an older one: the held one still waits
            ended.append(self._release())
        wait = WAIT + max(min(self._behind[body.other], default=0.0), 0.0)
        self._held.append(_Held(body, epoch, time + wait))
        return ended

    def poll(self, time: float) -> list[Pair]:
        """Return the epochs whose partners have not come until this monotonic time (s)."""
        ended = []
        while self._held and time >= self._held[0].until:
            ended.append(self._release())
        return ended

    def _release(self) -> Pair:
        held = self._held.popleft()
        return self._alone(held.body, held.epoch)

    def _alone(self, body: Body, epoch: Epoch) -> Pair:
        self.dropped[f"{body.value} alone"] += 1
        return _pair({body: epoch})

    def _half_interval(self) -> float:
        """Return half the interval of the faster receiver's epochs, s."""
        intervals = [sorted(steps)[:2][-1] for steps in self._steps.values() if steps]
        return min(intervals, default=_USUAL_INTERVAL) / 2.0

    def _learn(self, body: Body, epoch: Epoch, time: float) -> None:
        """Learn the interval of a receiver's epochs, and how long after the other's it comes."""
        before = self._came[body][-1][0] if self._came[body] else epoch.utc
        step = difference(epoch.utc, before)
        if SAME_EPOCH < step < _LONGEST_INTERVAL:
            self._steps[body].append(step)
        self._came[body].append((epoch.utc, time))
        for utc, came in self._came[body.other]:
            if abs(difference(epoch.utc, utc)) < self._half_interval() and time - came <= MOST_BEHIND:
                self._behind[body].append(time - came)
                self._behind[body.other].append(came - time)


def _pair(epochs: dict[Body, Epoch]) -> Pair:
    return Pair(tractor=epochs.get(Body.TRACTOR), trailer=epochs.get(Body.TRAILER))
