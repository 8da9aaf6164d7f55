"""From CasADi to machine code: C generation, compiler discovery, build cache, loading."""

from drawbar.codegen.cache import build, watch_compilation
from drawbar.codegen.library import Workspace
from drawbar.codegen.recurrence import CompiledRecurrence
from drawbar.codegen.unit import Component, Unit

__all__ = ["CompiledRecurrence", "Component", "Unit", "Workspace", "build", "watch_compilation"]
