"""From CasADi to machine code: C generation, compiler discovery, build cache, loading."""

from drawbar.codegen.cache import build
from drawbar.codegen.function import CompiledFunction
from drawbar.codegen.library import Workspace
from drawbar.codegen.unit import Component, Unit

__all__ = ["CompiledFunction", "Component", "Unit", "Workspace", "build"]
