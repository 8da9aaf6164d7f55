"""The signals between components as C structures: plain ones by their layout, the two that hold pointers by hand."""

import ctypes
from functools import cache
from typing import Any, Self

import numpy as np

from drawbar.geometry import Floats
from drawbar.signals import BodyPlan, BodyReference, SolverStatus
from drawbar.signals.layout import Layout

Real = ctypes.c_double
Reals = ctypes.POINTER(Real)

_layout = cache(Layout)


def room(kind: Any) -> Any:
    """Return C's memory for a signal without pointers."""
    return _layout(kind).buffer()


def given(signal: Any) -> Any:
    """Return a signal without pointers in C's memory."""
    memory = room(type(signal))
    _layout(type(signal)).pack(memory, signal)
    return memory


def taken(kind: Any, memory: Any) -> Any:
    """Return the signal without pointers that is in C's memory."""
    return _layout(kind).unpack(memory)


class _WithArrays(ctypes.Structure):
    """A structure that points to arrays."""

    def point(self, name: str, array: Floats) -> None:
        """Let a member point to an array, which is kept alive."""
        kept = np.ascontiguousarray(array, np.float64)
        setattr(self, name, kept.ctypes.data_as(Reals))
        setattr(self, f"_{name}", kept)

    def array(self, name: str, *shape: int) -> Floats:
        """Return a copy of what a member points to."""
        return np.ctypeslib.as_array(getattr(self, name), shape).copy()


class CBodyReference(_WithArrays):
    """struct drawbar_body_reference."""

    _fields_ = (("progress", Real), ("lateral_error", Real), ("closest", Real * 4), ("samples", Reals))

    @classmethod
    def of(cls, reference: BodyReference) -> Self:
        """Return a reference in C's memory."""
        made = cls(reference.progress, reference.lateral_error, (Real * 4)(*reference.closest))
        made.point("samples", reference.samples)
        return made

    def read(self, stages: int) -> BodyReference:
        """Return a copy; it has one sample more than stages."""
        return BodyReference(
            progress=self.progress,
            lateral_error=self.lateral_error,
            closest=np.array(self.closest),
            samples=self.array("samples", stages + 1, 4),
        )


class CBodyPlan(_WithArrays):
    """struct drawbar_body_plan."""

    _fields_ = (
        ("steering", Real),
        ("poses", Reals),
        ("steerings", Reals),
        ("deviation", Reals),
        ("status", ctypes.c_int32),
        ("deviations", ctypes.c_int32),
    )

    @classmethod
    def of(cls, plan: BodyPlan) -> Self:
        """Return a plan in C's memory."""
        made = cls(steering=plan.steering, status=plan.status, deviations=len(plan.deviation))
        for name in ("poses", "steerings", "deviation"):
            made.point(name, getattr(plan, name))
        return made

    def read(self, stages: int) -> BodyPlan:
        """Return a copy; it has one pose more than stages."""
        return BodyPlan(
            steering=self.steering,
            poses=self.array("poses", stages + 1, 3),
            steerings=self.array("steerings", stages),
            deviation=self.array("deviation", self.deviations) if self.deviations else np.zeros(0),
            status=SolverStatus(self.status),
        )


class CNeighbour(ctypes.Structure):
    """struct drawbar_neighbour."""

    _fields_ = (("reference", ctypes.POINTER(CBodyReference)), ("plan", ctypes.POINTER(CBodyPlan)))
