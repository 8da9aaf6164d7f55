"""Visitors: who sits at a browser, known by a random cookie, and what that person may do."""

import secrets
from collections import OrderedDict
from dataclasses import dataclass
from enum import IntEnum

COOKIE = "drawbar"
MOST = 64
"""visitors that are remembered; the least recently active is forgotten first"""
LIFE = 12 * 3600.0
"""without a request, after which a visitor is forgotten, s"""


class Rank(IntEnum):
    """What a visitor may do; each may do what those before may."""

    VIEWER = 0
    """look, stop, release"""
    OPERATOR = 1
    """engage and drive"""
    MAINTAINER = 2
    """change what is set up, delete runs"""


@dataclass(slots=True, kw_only=True, eq=False)
class Visitor:
    """One browser."""

    token: str
    """128 random bits, the value of its cookie"""
    number: int
    """of its session at the gate"""
    name: str
    rank: Rank
    is_known: bool = True
    """no more once the visitor has logged out, or was inactive for too long: pages that are open then look and stop"""

    @property
    def may_drive(self) -> bool:
        """Whether more is allowed than to look and to stop."""
        return self.is_known and self.rank >= Rank.OPERATOR

    @property
    def may_maintain(self) -> bool:
        """Whether what is set up may be changed, and runs deleted."""
        return self.is_known and self.rank >= Rank.MAINTAINER


class Visitors:
    """All browsers that are known."""

    def __init__(self) -> None:
        """Begin with none."""
        self._known: OrderedDict[str, tuple[Visitor, float]] = OrderedDict()
        self._count = 0

    def admit(self, name: str, rank: Rank, time: float) -> Visitor:
        """Return a new visitor, known from a time, s."""
        self._count += 1
        visitor = Visitor(
            token=secrets.token_urlsafe(24),
            number=secrets.randbits(62) | 2,
            name=name or f"{self._count}",
            rank=rank,
        )
        self._known[visitor.token] = (visitor, time)
        if len(self._known) > MOST:
            self.dismiss(next(iter(self._known)))
        return visitor

    def find(self, token: str, time: float) -> Visitor | None:
        """Return the visitor with this token, active at a time, s; None: unknown."""
        found = self._known.get(token)
        if found is None:
            return None
        if not (time - found[1] <= LIFE):
            self.dismiss(token)
            return None
        self._known[token] = (found[0], time)
        self._known.move_to_end(token)
        return found[0]

    def dismiss(self, token: str) -> None:
        """Forget a visitor; what pages of it are still open may only look and stop."""
        found = self._known.pop(token, None)
        if found is not None:
            found[0].is_known = False
