"""Code generation: C from CasADi, compiler discovery, build cache, loading.

CasADi itself is imported by those alone who generate C from it: `statements.py`, `emit.py`, `recurrence.py`.
"""

from drawbar.codegen.cache import build, watch_compilation
from drawbar.codegen.library import Workspace
from drawbar.codegen.unit import Component, Unit

__all__ = ["Component", "Unit", "Workspace", "build", "watch_compilation"]
