"""The nominal controllers of the whole vehicle behind one interface."""

from abc import ABC, abstractmethod

from drawbar.signals import Estimate, Plan, Reference, SolveTimes


class NominalController(ABC):
    """Plans the nominal motion of both bodies at every sample."""

    @abstractmethod
    def feedback(self, estimate: Estimate, reference: Reference) -> Plan:
        """Return both bodies' plans from the newest estimate."""

    @abstractmethod
    def prepare(self) -> None:
        """Do what can be done before the next estimate is known."""

    @property
    @abstractmethod
    def times(self) -> tuple[SolveTimes, SolveTimes]:
        """Wall-clock time of the last two phases for tractor and trailer, s."""
