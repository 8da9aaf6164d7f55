"""Worst-case stack of a library: the deepest chain of calls, summed over the frames of its functions.

The code has no recursion and no pointers to functions, so the graph of calls is finite and complete. What a function
of the C library (sine, memcpy) uses is not known here; it comes on top.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from drawbar.errors import CompilerError
from drawbar.export.objects import ObjectFile

_Function = tuple[int, str]
"""unit and name: two units may have functions of the same name"""


@dataclass(frozen=True, slots=True, kw_only=True)
class StackUse:
    """The deepest chain of calls below one function."""

    size: int
    """bytes"""
    chain: tuple[str, ...]
    """the functions on it, outermost first"""


class CallGraph:
    """Which function of a library calls which, over all its units."""

    def __init__(self, units: Sequence[ObjectFile]) -> None:
        """Take the units' object files."""
        self._units = units
        self._offered = {name: (i, name) for i, unit in enumerate(units) for name in unit.offered}
        self._deepest: dict[_Function, StackUse] = {}

    def worst(self, entry: str) -> StackUse:
        """Return the stack use below a function that some unit offers.

        Raises:
            CompilerError: a function calls itself in the end.
        """
        return self._below(self._offered[entry], ())

    def outside(self) -> list[str]:
        """Return what the library needs of others: functions of the C library."""
        wanted = {(i, name) for i, unit in enumerate(self._units) for names in unit.calls.values() for name in names}
        return sorted({name for i, name in wanted if self._found(i, name) is None})

    def _found(self, unit: int, name: str) -> _Function | None:
        return (unit, name) if name in self._units[unit].calls else self._offered.get(name)

    def _called(self, function: _Function) -> Iterator[_Function]:
        unit, name = function
        for called in sorted(self._units[unit].calls[name]):
            if (found := self._found(unit, called)) is not None:
                yield found

    def _below(self, function: _Function, above: tuple[_Function, ...]) -> StackUse:
        if function in above:
            raise CompilerError(f"{function[1]} calls itself, directly or through others: its stack has no bound.")
        if function not in self._deepest:
            uses = [self._below(called, (*above, function)) for called in self._called(function)]
            deepest = max(uses, key=lambda use: use.size, default=StackUse(size=0, chain=()))
            unit, name = function
            frame = self._units[unit].stack[name]
            self._deepest[function] = StackUse(size=frame + deepest.size, chain=(name, *deepest.chain))
        return self._deepest[function]
