"""Base of every machine, its one interface: simulated, replayed, or real."""

from abc import ABC, abstractmethod
from types import TracebackType
from typing import Self

from drawbar.signals import Command, Measurement, Truth


class Machine(ABC):
    """A tractor with a trailer, as a context: whatever happens in it, `stop` is called at the end.

    Each sample: read(), then write() as soon as the command is known. The clock belongs to the machine: it decides when
    a sample is due, and stamps it.
    """

    @abstractmethod
    def read(self) -> Measurement:
        """Wait for the next sample and return what the sensors report.

        Raises:
            EndOfMeasurements: there will be no more.
        """

    @abstractmethod
    def write(self, command: Command) -> None:
        """Hand the command to the actuators, and return at once.

        Raises:
            HardwareError: the command is not finite or outside what the machine accepts; it was not taken over.
        """

    @abstractmethod
    def stop(self) -> None:
        """Stop the vehicle with its steering held. Always possible, in any state, also when called again."""

    def close(self) -> None:
        """Give everything back that the machine holds; it is not used again."""
        return

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.stop()
        except (KeyboardInterrupt, SystemExit):  # impatience, while it is being stopped
            self.stop()
            raise
        finally:
            self.close()


class MachineWithTruth(Machine):
    """A simulated machine, which has the truth besides its measurements."""

    @abstractmethod
    def truth(self) -> Truth:
        """Return the true state at the time of the newest measurement."""


class EndOfMeasurements(Exception):  # noqa: N818 -- an end, not a mistake
    """A machine whose measurements are given beforehand has no more of them."""
