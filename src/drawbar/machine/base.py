"""The one interface of every machine: simulated, hardware or replayed."""

from abc import ABC, abstractmethod

from drawbar.signals import Command, Measurement, Truth


class Machine(ABC):
    """A tractor with a trailer. Each control step calls read() and then write(), once per sample period."""

    @abstractmethod
    def read(self) -> Measurement:
        """Return what the sensors report now; reading again before the next write() reports the same."""

    @abstractmethod
    def write(self, command: Command) -> None:
        """Hand the command to the actuators and let one sample period pass.

        Raises HardwareError when the command is not finite or outside what the machine accepts.
        """

    @abstractmethod
    def truth(self) -> Truth | None:
        """Return what only a simulation knows, at the time of read(); None on a real machine."""
