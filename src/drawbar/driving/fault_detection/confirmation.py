"""Confirmation: whether something has held for as many samples in a row as are no chance."""

CONFIRMED = 3
"""samples"""


class Confirmation:
    """How many samples in a row something has held."""

    def __init__(self) -> None:
        """Begin at none."""
        self._count = 0

    def update(self, *, holds: bool) -> bool:
        """Update with a sample; return whether it is confirmed."""
        self._count = self._count + 1 if holds else 0
        return self.is_confirmed

    @property
    def is_confirmed(self) -> bool:
        """Whether it has held for long enough."""
        return self._count >= CONFIRMED
