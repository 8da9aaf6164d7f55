"""Decentralised control: two small problems instead of one large one (equation DeNMPC)."""

from drawbar.control.nominal import NominalController
from drawbar.control.subsystem import SubsystemController
from drawbar.signals import Estimate, Plan, Reference, SolveTimes


class DecentralisedController(NominalController):
    """The tractor's and the trailer's controllers, each solving for itself.

    The trailer's is handed the tractor's plan, which it reads only when its coupling is planned.
    """

    def __init__(self, tractor: SubsystemController, trailer: SubsystemController) -> None:
        """Join the controllers of the two bodies."""
        self.tractor, self.trailer = tractor, trailer

    def feedback(self, estimate: Estimate, reference: Reference) -> Plan:
        """Return both bodies' plans from the newest estimate."""
        tractor = self.tractor.feedback(estimate, reference.tractor)
        trailer = self.trailer.feedback(estimate, reference.trailer, tractor)
        return Plan(time=estimate.time, tractor=tractor, trailer=trailer)

    def prepare(self) -> None:
        """Prepare both solvers for the next sample."""
        self.tractor.prepare()
        self.trailer.prepare()

    @property
    def times(self) -> tuple[SolveTimes, SolveTimes]:
        """Wall-clock time of the last two phases for tractor and trailer, s."""
        return self.tractor.times, self.trailer.times
