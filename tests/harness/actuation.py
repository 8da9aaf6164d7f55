"""The identification of both steerings by itself."""

from ctypes import byref

from alone import Alone
from c_signals import Real, given, room, taken

from drawbar.estimation.actuation import actuation_unit
from drawbar.estimation.actuation_settings import ActuationSettings
from drawbar.signals import Actuation, Command, Estimate, Measurement
from drawbar.vehicle.parameters import VehicleParameters


class Identification(Alone):
    """What finds dead times and lags."""

    def __init__(self, vehicle: VehicleParameters, settings: ActuationSettings, sample_time: float) -> None:
        """Take what is stated, and how to search."""
        super().__init__(actuation_unit(vehicle, settings, sample_time))

    def measured(self, measurement: Measurement) -> int:
        """Take in the steering angles of a measurement; return 0 or the status with which a run would end."""
        return self.call("measured", given(measurement))

    def sent(self, command: Command) -> Command:
        """Take in the command that was sent; return what the sensors will say of it."""
        memory = given(command)
        self.call("sent", memory)
        return taken(Command, memory)

    def adapt(self, then: Estimate, tractor: float, trailer: float) -> tuple[float, float]:
        """Return commands for the lags that were found in place of those for the stated ones."""
        commands = Real(tractor), Real(trailer)
        self.call("adapt", given(then), *(byref(command) for command in commands))
        return commands[0].value, commands[1].value

    def found(self) -> Actuation:
        """Return what is known, and what is planned with."""
        memory = room(Actuation)
        self.call("report", memory)
        return taken(Actuation, memory)
