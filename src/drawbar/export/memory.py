"""Memory of an exported library's state."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

from drawbar.codegen import Component
from drawbar.step.library import STEP_DOUBLES


@dataclass(frozen=True, slots=True, kw_only=True)
class Memory:
    """What one vehicle's autopilot takes."""

    components: Mapping[str, int]
    """bytes of each, by name"""
    work: int
    """bytes of the scratch memory that all components use in turn"""

    @classmethod
    def of(cls, components: Sequence[Component]) -> Self:
        """Return the memory of components as Python's own library has them."""
        return cls(
            components={component.name: component.size for component in components},
            work=max(8, *(component.work_size for component in components)),
        )

    @property
    def state_doubles(self) -> int:
        """The whole state, in doubles."""
        return sum(-(-size // 8) for size in (*self.components.values(), self.work)) + STEP_DOUBLES
