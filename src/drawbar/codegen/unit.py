"""A translation unit of the control step, as data: C that defines `struct component`, and who sets its settings."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from drawbar.codegen.library import Workspace, aligned, integer

_HOSTED = """\
#define DRAWBAR_HOSTED
#define UNIT(name) drawbar_{name}_##name
{source}
#include "hosted.h"
const struct drawbar_field UNIT(fields)[] = {{{fields} COMPONENT_FIELDS END_OF_FIELDS}};
{constants}
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """One component of the control step. Its C depends on structure alone; numbers are settings."""

    name: str
    """within its library, of C's letters"""
    source: str
    """C99 text, without the definition of UNIT (unit.h)"""
    configure: Callable[[Workspace], None]
    """writes the settings into the component's fields"""
    simulation_only: bool = False
    """no exported library can have it"""
    fields: str = ""
    """entries of the table of fields (fields.h) before the component's own COMPONENT_FIELDS"""
    constants: str = ""
    """C statement that lays down in `component` what follows from the settings alone; empty: there is nothing"""

    def hosted_text(self) -> str:
        """Return the unit's C file in Python's own library."""
        constants = f"int UNIT(constants)(struct component *component) {{ {self.constants}; return 0; }}"
        return _HOSTED.format(
            name=self.name,
            source=self.source.strip(),
            fields=self.fields,
            constants=constants if self.constants else "",
        )


class Component:
    """A unit's component in a loaded library of Python's own: memory of two structures, see hosted.h."""

    def __init__(self, unit: Unit, library: Path) -> None:
        """Allocate the memory and write the settings into it."""
        self.unit = unit
        size, self.work_size = (integer(library, f"drawbar_{unit.name}_{what}") for what in ("size", "work_size"))
        self.memory = aligned(2 * size)
        self.settings = Workspace(library, unit.name, self.memory[size:])
        """the structure that holds the settings, as which every run begins"""
        self.live = Workspace(library, unit.name, self.memory[:size])
        """the structure at work"""
        unit.configure(self.settings)
        if unit.constants:
            self.settings.function("constants")()
        self.live.function("initialise")()

    @property
    def name(self) -> str:
        """Name of the unit."""
        return self.unit.name

    @property
    def size(self) -> int:
        """Bytes of `struct component` on this machine."""
        return self.live.memory.size
