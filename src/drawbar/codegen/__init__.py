"""From CasADi to machine code: C generation, compiler discovery, build cache, loading."""

from drawbar.codegen.cache import build
from drawbar.codegen.function import CompiledFunction
from drawbar.codegen.library import Workspace

__all__ = ["CompiledFunction", "Workspace", "build"]
