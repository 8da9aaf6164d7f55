"""A component of the autopilot that has no solver, as a compiled unit of its own."""

from drawbar.codegen.cache import build
from drawbar.codegen.library import Workspace

_INTROSPECTION = """
#include "workspace.h"
const struct drawbar_field drawbar_fields[] = {COMPONENT_FIELDS END_OF_FIELDS};
"""


class Component(Workspace):
    """The workspace of a unit that defines `struct component`, functions of it, and its COMPONENT_FIELDS."""

    def __init__(self, name: str, source: str) -> None:
        """Compile the unit (or take it from the cache).

        Args:
            name: readable part of the library's file name.
            source: C99 text, in most cases the inclusion of one header of the runtime.

        Raises:
            CompilerError: no compiler, or it refused the code.
        """
        self.source = source
        super().__init__(build(name, source + _INTROSPECTION))
        self.work = self.memory.ctypes.data + self.work_offset
        """address of what the unit borrows for the length of a call"""
