"""The alignment by itself."""

from alone import Alone
from c_signals import given, room, taken

from drawbar.estimation.alignment import alignment_unit
from drawbar.signals import Actuation, Estimate, Measurement
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise


class Alignment(Alone):
    """From what sensors reported to what they would report of the points on the ground, now."""

    def __init__(self, vehicle: VehicleParameters, sensors: SensorNoise | None = None) -> None:
        """Take the masts and the lengths."""
        super().__init__(alignment_unit(vehicle, sensors or SensorNoise()))
        self.status = 0
        """with which the newest measurement ends the run, or 0"""

    def begin(self, first: Measurement) -> Measurement:
        """Return the measurement that a run begins with."""
        aligned = room(Measurement)
        self.call("begin", given(first), aligned)
        return taken(Measurement, aligned)

    def apply(self, measurement: Measurement, last: Estimate, expected: Estimate) -> Measurement:
        """Return the measurement of the points on the ground at its own time."""
        aligned = room(Measurement)
        self.status = self.call("apply", given(measurement), given(last), given(expected), aligned)
        return taken(Measurement, aligned)

    def found(self) -> Actuation:
        """Return what is found of the sensors; zero where that is of the steerings."""
        found = room(Actuation)
        self.call("report", found)
        return taken(Actuation, found)
