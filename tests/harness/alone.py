"""One component of the control step by itself, compiled as a library of its own."""

import ctypes
from typing import Any

from drawbar.codegen import Component, Unit, Workspace, build
from drawbar.codegen.library import aligned, load
from drawbar.geometry import Floats
from drawbar.guidance.path import PATH_UNIT
from drawbar.optimal import ControlProblem, EstimationProblem

ITERATIONS = 58
"""of interior points: what an estimator and two controllers may need together"""


class SolverResources(ctypes.Structure):
    """struct solver_resources of solver/solver_resources.h."""

    _fields_ = (("work", ctypes.c_void_p), ("iterations", ctypes.c_int32))


class Alone:
    """A component with its settings, ready to begin."""

    def __init__(self, unit: Unit) -> None:
        """Compile the unit (or take it from the cache)."""
        self.unit = unit
        library = build(unit.name, {f"{unit.name}.c": unit.hosted_text(), "path.c": PATH_UNIT})
        component = Component(unit, library)
        self.live: Workspace = component.live
        """the component's fields"""
        self._library, self._scratch = load(library), aligned(max(8, component.work_size))
        self.work = ctypes.c_void_p(self._scratch.ctypes.data)
        """its scratch memory"""
        self.resources = ctypes.byref(SolverResources(self.work, ITERATIONS))
        """those of its solver"""

    def call(self, name: str, *arguments: Any) -> int:
        """Call one of the component's functions on it; the arguments are those of ctypes."""
        component = ctypes.c_void_p(self.live.memory.ctypes.data)
        return int(getattr(self._library, f"drawbar_{self.unit.name}_{name}")(component, *arguments))


class Solver:
    """The solver with which a component begins: views into its memory, named as in drawbar.optimal."""

    def __init__(self, live: Workspace, problem: ControlProblem | EstimationProblem) -> None:
        """Take the component's fields and the problem that it solves."""
        self.workspace, self.problem = live, problem
        self.x: Floats = live.array("x")
        self.u: Floats = live.array("u")
        self.y: Floats = live.array("y")
        self.w: Floats = live.array("w")
        self.p: Floats = live.array("p")
        self.root: Floats = live.array("root")
        self.defects: Floats = live.array("qp.c")

    @property
    def newest(self) -> int:
        """Row of an estimator's newest measurement."""
        return int(self.workspace.array("window.newest")[0])
