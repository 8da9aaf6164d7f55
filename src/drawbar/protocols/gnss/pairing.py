"""Pairing: the epochs of two receivers, one on each body, by their own times."""

from collections import Counter
from dataclasses import dataclass
from enum import Enum

from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.timing import SAME_EPOCH, difference

WAIT = 0.06
"""for the second receiver after the first, s"""
_USUAL_INTERVAL = 0.2
"""of epochs, until it is known, s"""
_LONGEST_INTERVAL = 1.0
"""s; a longer step is a gap"""


class Body(Enum):
    """Whose antenna it is."""

    TRACTOR = "tractor"
    TRAILER = "trailer"


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """Epochs of one instant; None: the receiver has none of it."""

    tractor: Epoch | None
    trailer: Epoch | None


class Pairing:
    """Holds at most one epoch back; `dropped` counts those left alone and those that came too late to be of use."""

    dropped: Counter[str]

    def __init__(self, wait: float = WAIT) -> None:
        self.dropped = Counter()
        self._wait = wait
        self._held: tuple[Body, Epoch, float] | None = None  # and until when
        self._last: dict[Body, Epoch] = {}
        self._steps: dict[Body, float] = {}

    @property
    def due(self) -> float:
        """Monotonic time at which `poll` has something to do, infinite while there is nothing, s."""
        return self._held[2] if self._held else float("inf")

    def add(self, body: Body, epoch: Epoch, time: float) -> list[Pair]:
        """Take an epoch that one body's receiver ended at a monotonic time (s); return the pairs that it ends."""
        ended = self.poll(time)
        self._learn(body, epoch)
        if self._held is not None:
            other, held, _ = self._held
            if other is not body and abs(difference(epoch.utc, held.utc)) < self._half_interval():
                self._held = None
                return [*ended, _pair({body: epoch, other: held})]
            if other is not body and difference(epoch.utc, held.utc) < 0.0:
                return [*ended, self._alone(body, epoch)]  # an older one: the held one still waits
            ended += self._release()
        self._held = (body, epoch, time + self._wait)
        return ended

    def poll(self, time: float) -> list[Pair]:
        """Return the epoch whose partner has not come until this monotonic time (s)."""
        return self._release() if self._held is not None and time >= self._held[2] else []

    def _release(self) -> list[Pair]:
        if self._held is None:
            return []
        body, epoch, _ = self._held
        self._held = None
        return [self._alone(body, epoch)]

    def _alone(self, body: Body, epoch: Epoch) -> Pair:
        self.dropped[f"{body.value} alone"] += 1
        return _pair({body: epoch})

    def _half_interval(self) -> float:
        """Return half the interval of the faster receiver's epochs, s."""
        return min(self._steps.values(), default=_USUAL_INTERVAL) / 2.0

    def _learn(self, body: Body, epoch: Epoch) -> None:
        before, self._last[body] = self._last.get(body), epoch
        step = difference(epoch.utc, before.utc) if before is not None else 0.0
        if SAME_EPOCH < step < _LONGEST_INTERVAL:
            self._steps[body] = step


def _pair(epochs: dict[Body, Epoch]) -> Pair:
    return Pair(tractor=epochs.get(Body.TRACTOR), trailer=epochs.get(Body.TRAILER))
