"""One unit of a library: a component of the autopilot as it was compiled for this very configuration."""

from dataclasses import dataclass

from drawbar.codegen import Workspace


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """One component of the autopilot: what Python compiled, and the memory that it works on."""

    name: str
    """short, of C's letters"""
    source: str
    """C that defines `struct component` and its functions"""
    workspace: Workspace
    has_solver: bool

    @property
    def size(self) -> int:
        """Bytes of `struct component` on this machine."""
        return self.workspace.part_size

    @property
    def work_size(self) -> int:
        """Bytes that the component borrows for the length of a call."""
        return self.workspace.memory.size - self.workspace.work_offset
