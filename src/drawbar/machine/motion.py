"""Motion of the true world over a sample: under closed loops simulated as lags, or valves under drawbar_actuate."""

from abc import ABC, abstractmethod

import numpy as np

from drawbar.codegen.recurrence import CompiledRecurrence
from drawbar.geometry import Floats
from drawbar.machine.low_level.low_level import (
    ActuateInput,
    ActuateOutput,
    LowLevel,
    SpeedAxis,
    SteeringAxis,
    TableSensor,
)
from drawbar.machine.plant import COMMANDS, plant_constants, plant_step
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.steps import whole_steps
from drawbar.vehicle.parameters import VehicleParameters

_RANGE = 1.1
"""of the sensors of the simulated valves, in mechanical stops"""


class Motion(ABC):
    """The plant with what lies between commands and wheels."""

    state: Floats
    """(11,) of the plant (machine/plant.py), now"""

    @abstractmethod
    def advance(self, commands: Floats, effects: Floats) -> Floats:
        """Move on by the steps of one sample, and return the state after each, (steps, 11).

        Args:
            commands: (steps, 3) delta_t, joint (rad), wheel speed (m/s).
            effects: (steps, 8) of the ground.
        """


class LagMotion(Motion):
    """Closed loops, simulated as the lags that they amount to, and the paper's cascade of two PIDs."""

    def __init__(self, vehicle: VehicleParameters, settings: SimulatedMachineSettings, steps: int) -> None:
        """Compile the plant, or take it from the cache; its state is zero."""
        self._plant = CompiledRecurrence(plant_step(), steps)
        self._plant.constants[:] = plant_constants(vehicle, settings)
        self.state = self._plant.state

    def advance(self, commands: Floats, effects: Floats) -> Floats:
        """Let the compiled plant take all steps at once."""
        self._plant.inputs[:, :COMMANDS] = commands
        self._plant.inputs[:, COMMANDS:] = effects
        self._plant()
        self.state[:] = self._plant.states[-1]
        return self._plant.states


class ValveMotion(Motion):
    """Valves and a pedal's motor, driven by drawbar_actuate once in each step, over sensors of a finite resolution."""

    def __init__(self, vehicle: VehicleParameters, settings: SimulatedMachineSettings) -> None:
        """Compile plant and low level, or take them from the cache; the plant's state is zero."""
        self._settings = settings
        self._plant = CompiledRecurrence(plant_step("valve"), 1)
        self._plant.constants[:] = plant_constants(vehicle, settings)
        self.state = self._plant.state
        self._low_level = _low_level(settings)
        delay = whole_steps(settings.low_level.dead_time, settings.step) or 0
        self._drives: Floats = np.zeros((delay + 1, COMMANDS))
        self._time = 0.0

    def advance(self, commands: Floats, effects: Floats) -> Floats:
        """Sense, actuate and move, step by step."""
        states = []
        for command, effect in zip(commands, effects, strict=True):
            self._drives[:-1] = self._drives[1:]
            self._drives[-1] = self._actuate(*command.tolist()).drives
            self._plant.inputs[0, :COMMANDS] = self._drives[0]
            self._plant.inputs[0, COMMANDS:] = effect
            self._plant()
            self.state[:] = self._plant.states[0]
            self._time += self._settings.step
            states.append(self.state.copy())
        return np.array(states)

    def _actuate(self, front: float, joint: float, speed: float) -> ActuateOutput:
        _, _, _, _, joint_angle, front_angle, wheel_speed, pedal, *_ = self.state.tolist()
        low_level = self._settings.low_level
        return self._low_level.step(
            ActuateInput(
                time=self._time,
                measured_speed=low_level.speed_step * round(wheel_speed / low_level.speed_step),
                counts=(
                    round(front_angle / low_level.sensor_step),
                    round(joint_angle / low_level.sensor_step),
                    round(pedal / low_level.pedal_step),
                ),
                steering=(front, joint),
                speed=speed,
                steer=(True, True),
                drive=True,
            )
        )


def _low_level(settings: SimulatedMachineSettings) -> LowLevel:
    low_level, actuators = settings.low_level, settings.actuators
    front, joint = (
        _linear(low_level.sensor_step, -stop, stop) for stop in (actuators.tractor_stop, actuators.trailer_stop)
    )
    return LowLevel(
        front=SteeringAxis(sensor=front, loop=low_level.front_loop, limit=actuators.tractor_stop),
        joint=SteeringAxis(sensor=joint, loop=low_level.joint_loop, limit=actuators.trailer_stop),
        pedal=SpeedAxis(
            sensor=_linear(low_level.pedal_step, -1.0, 1.0),
            loop=low_level.pedal_loop,
            speed=low_level.speed_loop,
            full_speed=settings.hydrostat.full_speed,
        ),
        longest_period=max(0.1, 2.0 * settings.step),
    )


def _linear(step: float, low: float, high: float) -> TableSensor:
    """Return a sensor whose counts are multiples of a step."""
    counts = (_RANGE * low / step, _RANGE * high / step)
    return TableSensor(counts=counts, values=(_RANGE * low, _RANGE * high), lowest=counts[0], highest=counts[1])
