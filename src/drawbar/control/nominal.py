"""The nominal controllers of the whole vehicle behind one interface."""

import math
from abc import ABC, abstractmethod

from drawbar.signals import Estimate, Plan, Reference, SolveTimes

NO_SOLVER = SolveTimes(prepare=math.nan, feedback=math.nan)
"""The times of a body that has no solver of its own."""


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
        """Wall-clock time of the last two phases for tractor and trailer, s; NaN for a body without a solver."""
