"""A machine that reports what another one measured: the recorded samples, one after the other."""

from collections.abc import Iterable

from drawbar.machine.base import EndOfMeasurements, Machine
from drawbar.signals import Command, Measurement


class ReplayedMachine(Machine):
    """Reports recorded measurements, whatever it is commanded; nothing moves."""

    def __init__(self, measurements: Iterable[Measurement]) -> None:
        """Take the measurements in the order of their samples."""
        self._measurements = iter(measurements)

    def read(self) -> Measurement:
        """Return the next recorded measurement, without waiting.

        Raises:
            EndOfMeasurements: there are no more.
        """
        try:
            return next(self._measurements)
        except StopIteration:
            raise EndOfMeasurements from None

    def write(self, command: Command) -> None:
        """Do nothing: what was commanded then has long moved the machine."""

    def stop(self) -> None:
        """Do nothing: nothing moves."""
