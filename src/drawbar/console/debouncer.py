"""Debouncer: ignores taps that bounce, and taps on a button that has just come to its place. Pure."""

from collections.abc import Hashable, Mapping

from drawbar.messages import Action

SETTLING = 600_000_000
"""a button counts once it is where it is for so long; the same tap counts again after it, ns"""
_ONCE = frozenset({Action.ARM, Action.ENGAGE, Action.ACKNOWLEDGE})
"""what is never meant twice in a row"""


class Debouncer:
    """When which buttons came to their places, and what was asked for last. Time is given, in ns."""

    def __init__(self) -> None:
        """Begin with a page that is new: its buttons count at once."""
        self._places: dict[Action, Hashable] = {}
        self._moved: dict[Action, int] = {}
        self._last: dict[Action, int] = {}

    def show(self, places: Mapping[Action, Hashable], now: int) -> None:
        """Take what the place of the button of each action depends on."""
        for action, place in places.items():
            if self._places.get(action, place) != place:
                self._moved[action] = now
            self._places[action] = place

    def counts(self, action: Action, now: int) -> bool:
        """Return whether a tap on the button of an action is meant."""
        if action in self._moved and now - self._moved[action] < SETTLING:
            return False
        return not (action in _ONCE and action in self._last and now - self._last[action] < SETTLING)

    def ask(self, action: Action, now: int) -> None:
        """Take note that something is asked for."""
        self._last[action] = now
