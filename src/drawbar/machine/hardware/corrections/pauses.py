"""The pauses between attempts to reach a caster: long enough that none bans us, random so that no fleet queues."""

from random import Random

PAUSES = (1.0, 10.0, 20.0, 40.0, 60.0)
"""after the first failure, the second, ..., s; the last one continues"""
SPREAD = 0.2
"""each is made longer or shorter by up to this share"""
BAN = 10.0
"""casters ban clients that come back sooner, again and again, s"""
REFUSED = 60.0
"""after a refusal that only the operator can mend, at least, s"""


class Pauses:
    """How long to wait after each failure."""

    def __init__(self, chance: Random) -> None:
        self._chance = chance
        self._failures = 0

    def after_failure(self, refused: bool) -> float:
        """Return the pause after one more failure, s; `refused`: of a kind that only the operator can mend."""
        nominal = PAUSES[min(self._failures, len(PAUSES) - 1)]
        shortest = REFUSED if refused else BAN if self._failures else 0.0
        self._failures += 1
        spread = self._chance.uniform(1.0 - SPREAD, 1.0 + SPREAD)
        return max(shortest, (REFUSED if refused else nominal) * spread)

    def settled(self) -> None:
        """Restart: a connection has lasted."""
        self._failures = 0
