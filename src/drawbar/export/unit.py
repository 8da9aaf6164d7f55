"""One unit of a library: a part of the autopilot as it was compiled for this very configuration."""

from dataclasses import dataclass

from drawbar.codegen import Workspace


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """One part of the autopilot: what Python compiled, and the memory that it works on."""

    name: str
    """short, of C's letters"""
    source: str
    """C that defines `struct part` and its functions"""
    workspace: Workspace
    has_solver: bool

    @property
    def size(self) -> int:
        """Bytes of `struct part` on this machine."""
        return self.workspace.part_size

    @property
    def work_size(self) -> int:
        """Bytes that the part borrows for the length of a call."""
        return self.workspace.memory.size - self.size
