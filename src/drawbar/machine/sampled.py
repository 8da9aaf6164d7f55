"""A machine in a computer that moves from sample to sample: what chain of axles and multibody have in common."""

import math
from abc import abstractmethod

import numpy as np

from drawbar.errors import ConfigurationError
from drawbar.geometry import Floats
from drawbar.machine.base import MachineWithTruth
from drawbar.machine.command import accepted
from drawbar.machine.history import History
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.machine.plant import COMMANDS
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.simulated_sensors import SimulatedSensors
from drawbar.machine.slide import Slide
from drawbar.machine.steps import steps_per_sample, whole_steps
from drawbar.signals import Command, Measurement, Pose
from drawbar.vehicle.parameters import VehicleParameters

BLOCK = 64
"""Samples whose randomness is drawn at once. Part of what a seed means: another value gives another run."""


class SampledMachine(MachineWithTruth):
    """Passes time when it is read; commands act after the actuators' dead time."""

    _sensors: SimulatedSensors
    _history: History

    def __init__(
        self,
        vehicle: VehicleParameters,
        settings: SimulatedMachineSettings | PhysicsMachineSettings,
        sample_time: float,
        start: Pose,
    ) -> None:
        """Take vehicle, settings and sample time (s); who inherits makes `_sensors` and `_history`, and draws.

        Raises:
            ConfigurationError: the sample time is not a multiple of the step, the start is not finite, or no vehicle
                has such lengths.
        """
        if not all(map(math.isfinite, (start.x, start.y, start.yaw))):
            raise ConfigurationError(f"the {settings.kind} machine cannot start at {start}; give finite m and rad")
        self._vehicle, self._sample_time = settings.lengths.applied_to(vehicle), sample_time
        self._steps, self._full_speed = steps_per_sample(sample_time, settings.step), settings.hydrostat.full_speed
        delay = whole_steps(settings.actuators.dead_time, settings.step) or 0
        self._commands = np.zeros((delay + self._steps, COMMANDS))
        self._newest = (0.0, 0.0, 0.0)
        self._sample, self._begun = 0, False

    @abstractmethod
    def slide(self, speed: float) -> Slide:
        """Return how the ground draws every axle at a speed (m/s)."""

    def read(self) -> Measurement:
        """Let one sample period pass under the newest command, and return what the sensors report then.

        The first measurement is that of the machine where it was placed.
        """
        if self._begun:
            self._let_pass()
        self._begun = True
        return self._sensors.measure(self._sample, self._history)

    def write(self, command: Command) -> None:
        """Take over the command, which acts from now on.

        Raises HardwareError when the command is not finite or beyond the limits; then the last one stays in effect.
        """
        self._newest = accepted(command, self._vehicle, self._full_speed)

    def stop(self) -> None:
        """Stop with the steering held."""
        self._newest = *self._newest[:2], 0.0

    def _let_pass(self) -> None:
        self._commands[: -self._steps] = self._commands[self._steps :]
        self._commands[-self._steps :] = self._newest
        self._move(self._commands[: self._steps])
        self._sample += 1
        if self._sample % BLOCK == 0:
            self._draw()

    @abstractmethod
    def _move(self, commands: Floats) -> None:
        """Move on by one sample period under commands (steps, COMMANDS)."""

    @abstractmethod
    def _draw(self) -> None:
        """Draw the randomness of the next block of samples, always as much and in the same order."""
