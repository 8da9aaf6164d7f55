"""What a controller of the whole vehicle hands to its C at every sample, and the plans that it gets back."""

import ctypes

from drawbar.exchange import CBodyPlan, CBodyReference, CEstimate
from drawbar.signals import Estimate, Plan, Reference


class BothBodies:
    """The estimate, both references and both plans as C structures that last."""

    def __init__(self, horizon: int) -> None:
        """Take the number of samples that a plan covers."""
        self._horizon = horizon
        self._estimate = CEstimate()
        self._references = CBodyReference(), CBodyReference()
        self._plans = CBodyPlan(), CBodyPlan()
        self.given = tuple(map(ctypes.byref, (self._estimate, *self._references)))
        """addresses of the estimate and of tractor's and trailer's reference"""
        self.plans = tuple(map(ctypes.byref, self._plans))
        """addresses of tractor's and trailer's plan"""

    def write(self, estimate: Estimate, reference: Reference) -> None:
        """Take over what is given."""
        self._estimate.write(estimate)
        for structure, body in zip(self._references, (reference.tractor, reference.trailer), strict=True):
            structure.write(body, self._horizon + 1)

    def plan(self, time: float) -> Plan:
        """Return both plans, made at a time (s)."""
        tractor, trailer = (plan.read(self._horizon) for plan in self._plans)
        return Plan(time=time, tractor=tractor, trailer=trailer)
