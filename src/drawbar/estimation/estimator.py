"""What every estimator of the vehicle offers to the control step."""

from abc import ABC, abstractmethod

from drawbar.signals import Command, Estimate, Measurement, SolveTimes


class Estimator(ABC):
    """Turns each measurement into an estimate; prepares for the next one after the command is out."""

    @abstractmethod
    def update(self, measurement: Measurement) -> Estimate:
        """Return the estimate at the measurement's time; missing values are NaN."""

    @abstractmethod
    def prepare(self, command: Command | None = None) -> None:
        """Do what can be done before the next measurement is known.

        command: what the actuators are asked for until then; None where nobody tells.
        """

    @property
    @abstractmethod
    def times(self) -> SolveTimes:
        """Wall-clock time of the last two phases, s."""
