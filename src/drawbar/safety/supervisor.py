"""The supervisor watches what the controllers cannot mend (supervisor.h)."""

import ctypes
from enum import IntEnum

from drawbar.codegen.component import Component
from drawbar.exchange import CBodyReference, CEstimate
from drawbar.signals import BodyReference, Estimate

LOST = 5.0
"""Distance of the tractor from the path at which a run is given up, m."""
BLIND = 15.0
"""Time without a fix of either antenna after which a run is given up, s: dead reckoning is off by then."""


class Supervision(IntEnum):
    """Whether a run may go on."""

    ON_COURSE = 0
    OFF_COURSE = 1
    """the tractor is too far from the path, or nowhere"""
    BLIND = 2
    """neither antenna has had a fix that was believed for too long"""


class Supervisor:
    """Watches a run from its first step on."""

    def __init__(self) -> None:
        """Compile the supervisor.

        Raises:
            CompilerError: no compiler, or it refused the code.
        """
        self.component = Component("supervisor", '#include "supervisor.h"')
        self.component.write({"lost": LOST, "blind": BLIND})
        self._estimate, self._reference = CEstimate(), CBodyReference()
        self._pointers = ctypes.byref(self._estimate), ctypes.byref(self._reference)
        self._watch = self.component.function("watch", pointers=2)

    def watch(self, estimate: Estimate, tractor: BodyReference) -> Supervision:
        """Judge one step by its estimate and the tractor's reference."""
        self._estimate.write(estimate)
        self._reference.write(tractor)
        return Supervision(self._watch(*self._pointers))
