"""Readings that no configuration has a key for: a sensor that turns the other way, references that stay or advance."""

from dataclasses import replace

from drawbar.experiment.alteration import InterceptedMachine
from drawbar.geometry import Floats
from drawbar.signals import Measurement
from drawbar.simulation import Simulation

TRACTOR, TRAILER = 0, 1


def joint_sensor_reversed(simulation: Simulation) -> None:
    """Let the joint's sensor turn the other way as well, together with its actuator."""

    def reverse(measurement: Measurement) -> Measurement:
        return replace(measurement, trailer_steering=-measurement.trailer_steering)

    simulation.machine = InterceptedMachine(simulation.machine, reverse)


def tractor_reference_constant(simulation: Simulation) -> None:
    """Let the tractor's reference stay at the point ahead, as the trailer's does."""
    _advance(simulation)[TRACTOR] = 0.0


def trailer_reference_advances(simulation: Simulation) -> None:
    """Let the trailer's reference advance along the path from stage to stage, as the tractor's does."""
    advance = _advance(simulation)
    advance[TRAILER] = advance[TRACTOR]


def _advance(simulation: Simulation) -> Floats:
    """Return by how much each body's reference advances from stage to stage, (2,) m, as every run begins."""
    return simulation.autopilot.library.components["guidance"].settings.array("advance")
