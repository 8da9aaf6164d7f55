"""The control step of one structure as a loaded library of Python's own, with memory for one vehicle.

It is compiled from the units that `drawbar export` writes, and `step.h`; DRAWBAR_HOSTED makes memory and numbers the
caller's, so that a changed number compiles nothing.
"""

import ctypes
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np

from drawbar import __version__
from drawbar.codegen import Component, Unit, build
from drawbar.codegen.compiler import find_compiler
from drawbar.codegen.library import aligned, load
from drawbar.errors import CompilerError
from drawbar.guidance.path import PATH_UNIT
from drawbar.statuses import Status

STEP_DOUBLES = 256
"""What the step itself remembers fits into so many doubles; the compiler checks it."""
_STEP = """\
#define _POSIX_C_SOURCE 200112L
#define DRAWBAR_HOSTED
#include "step.h"
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepSettings:
    """The step's own settings: struct step_settings, in its order."""

    sample_time: float
    """s"""
    speed: float
    """set speed, m/s"""
    planned_speed: float
    """least speed that plans reckon with, m/s; -inf: none"""
    acceleration: float
    """fastest change of the commanded speed, m/s²"""
    patience: float
    """for how long a command may act without a new one, s"""
    endurance: float
    """for how long the vehicle may be driven on predictions alone, s"""
    curvature: float
    """tightest line that may be driven beside a path, 1/m"""
    shift_curvature: float
    """largest of a shift from one line to the next beside it, 1/m"""
    shift_rate: float
    """largest change of that along the way, 1/m²"""
    iterations: float
    """of interior points, for all solvers of a step; each sample left out before takes one"""


class StepLibrary:
    """The compiled step with its components; what a caller in C would do by hand."""

    def __init__(self, units: Sequence[Unit], settings: StepSettings, horizon: int) -> None:
        """Compile the library (or take it from the cache) and give one vehicle its memory.

        Args:
            units: the components, in the order of struct autopilot.
            settings: of the step.
            horizon: stages of the plans.

        Raises:
            CompilerError: no compiler, it refused the code, or its arithmetic is not IEEE's.
        """
        self.file = build("autopilot", library_files(units, horizon))
        self._library = load(self.file)
        self.components = {unit.name: Component(unit, self.file) for unit in units}
        work = aligned(max(8, *(component.work_size for component in self.components.values())))
        self.state = (ctypes.c_double * (self._library.drawbar_state_size() // 8))()
        memories = [*(component.memory for component in self.components.values()), work]
        pointers = (ctypes.c_void_p * len(memories))(*(memory.ctypes.data for memory in memories))
        numbers = (ctypes.c_double * len(astuple(settings)))(*astuple(settings))
        self._memories = memories  # the library keeps no copies
        self.call("host", pointers, numbers)
        if status := self.call("init"):
            raise CompilerError(
                f"{' '.join(find_compiler())}: {Status(status).text}; unset CC or name another compiler."
            )
        self.record = np.zeros(self._library.drawbar_record_size(), np.uint8)
        """memory for one struct drawbar_record"""

    def remember(self) -> tuple[bytes, ...]:
        """Return all that the vehicle's memory holds."""
        return bytes(self.state), *(memory.tobytes() for memory in self._memories)

    def recall(self, memory: tuple[bytes, ...]) -> None:
        """Let the vehicle's memory hold again what it held; the path must be the same."""
        for place, held in zip((np.frombuffer(self.state, np.uint8), *self._memories), memory, strict=True):
            place.view(np.uint8)[:] = np.frombuffer(held, np.uint8)

    def function(self, name: str, *pointers: Any) -> Any:
        """Return a function of drawbar.h, bound to the state and to what further pointers lead to."""
        function = getattr(self._library, f"drawbar_{name}")
        function.argtypes = [ctypes.c_void_p] * (1 + len(pointers))
        addresses = [ctypes.c_void_p(ctypes.addressof(each)) for each in (self.state, *pointers)]
        return lambda: function(*addresses)

    def call(self, name: str, *arguments: Any) -> int:
        """Call a function of drawbar.h on the state."""
        return int(getattr(self._library, f"drawbar_{name}")(self.state, *arguments))


def library_files(units: Sequence[Unit], horizon: int) -> dict[str, str]:
    """Return the C files of Python's own library that are not headers of the package."""
    names = {unit.name for unit in units}
    lines = [
        *(["#define DRAWBAR_CENTRALISED"] if "controller" in names else []),
        *(["#define DRAWBAR_IDENTIFIED"] if "actuation" in names else []),
        *(["#define DRAWBAR_DEAD_TIME"] if "predictor" in names else []),
        f"#define DRAWBAR_STAGES {horizon}",
        f'#define DRAWBAR_VERSION "drawbar {__version__}"',
        "",
    ]
    return {
        **{f"{unit.name}.c": unit.hosted_text() for unit in units},
        "path.c": PATH_UNIT,
        "step.c": _STEP,
        "drawbar_components.h": "\n".join(lines),
        "drawbar_size.h": f"#define DRAWBAR_STATE_DOUBLES {STEP_DOUBLES}\n",
    }
