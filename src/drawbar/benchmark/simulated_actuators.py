"""Simulated actuators: a valve and a hydrostat by themselves, to try loops and calibrations on."""

from functools import cache

import casadi as ca
import numpy as np

from drawbar.codegen.recurrence import CompiledRecurrence
from drawbar.geometry import Floats
from drawbar.machine.actuators import pedal_rates, valve_rates
from drawbar.machine.low_level.settings import ValveSettings
from drawbar.machine.settings import HydrostatSettings

STEP = 0.001
"""integration step, s"""


class _Delayed:
    """A compiled plant behind a dead time."""

    def __init__(self, function: ca.Function, constants: Floats, dead_time: float) -> None:
        self._plant = CompiledRecurrence(function, 1)
        self._plant.constants[:] = constants
        self.state = self._plant.state
        self._waiting = [0.0] * round(dead_time / STEP)

    def advance(self, drive: float, other: Floats, duration: float) -> None:
        """Hold the drive for a duration, a multiple of the step; `other` inputs (n - 1,) act at once."""
        for _ in range(round(duration / STEP)):
            self._waiting.append(drive)
            self._plant.inputs[0, 0] = self._waiting.pop(0)
            self._plant.inputs[0, 1:] = other
            self._plant()
            self.state[:] = self._plant.states[0]


class SimulatedValve:
    """A cylinder behind a proportional valve."""

    def __init__(self, settings: ValveSettings, *, full_rate: float, stop: float, dead_time: float) -> None:
        """Place it at angle 0, at rest.

        Args:
            settings: dead bands, slope, lag.
            full_rate: rad/s to the left.
            stop: mechanical, rad.
            dead_time: s.
        """
        numbers = (settings.dead_band_left, settings.dead_band_right, settings.slope_right, settings.lag)
        self._plant = _Delayed(_valve_step(), np.array([*numbers, full_rate, stop]), dead_time)

    @property
    def angle(self) -> float:
        """Of the wheels, rad."""
        return float(self._plant.state[0])

    def advance(self, drive: float, duration: float) -> None:
        """Hold a drive, -1 to 1, for a duration, s."""
        self._plant.advance(drive, np.zeros(0), duration)


class SimulatedHydrostat:
    """A pedal with its motor, and the speed that it makes."""

    def __init__(self, settings: HydrostatSettings, *, dead_time: float) -> None:
        """Place it at rest."""
        numbers = (settings.full_speed, settings.speed_lag, settings.pedal_rate, settings.pedal_lag)
        self._plant = _Delayed(_hydrostat_step(), np.array(numbers), dead_time)

    @property
    def speed(self) -> float:
        """Of the wheels, m/s."""
        return float(self._plant.state[0])

    @property
    def pedal(self) -> float:
        """In strokes."""
        return float(self._plant.state[1])

    def advance(self, drive: float, resistance: float, duration: float) -> None:
        """Hold the motor's drive while a hill takes so much of the speed, m/s, for a duration, s."""
        self._plant.advance(drive, np.array([resistance]), duration)


@cache
def _valve_step() -> ca.Function:
    state, drive, constants = ca.SX.sym("x", 2), ca.SX.sym("u", 1), ca.SX.sym("c", 6)
    left, right, slope, lag, rate, stop = ca.vertsplit(constants)
    valve = ValveSettings.model_construct(dead_band_left=left, dead_band_right=right, slope_right=slope, lag=lag)
    end = state + STEP * valve_rates(valve, state, drive, full_rate=rate, stop=stop)
    end[0] = ca.fmin(ca.fmax(end[0], -stop), stop)
    return ca.Function("valve", [state, drive, constants], [end])


@cache
def _hydrostat_step() -> ca.Function:
    state, inputs, constants = ca.SX.sym("x", 3), ca.SX.sym("u", 2), ca.SX.sym("c", 4)
    speed, lag, rate, pedal_lag = ca.vertsplit(constants)
    settings = HydrostatSettings.model_construct(full_speed=speed, speed_lag=lag, pedal_rate=rate, pedal_lag=pedal_lag)
    end = state + STEP * pedal_rates(settings, state, inputs[0], inputs[1])
    end[1] = ca.fmin(ca.fmax(end[1], 0.0), 1.0)
    return ca.Function("hydrostat", [state, inputs, constants], [end])
