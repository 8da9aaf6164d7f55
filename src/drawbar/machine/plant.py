"""Plant: the simulated world over one sample period; chain, steering and drive, by RK4 at its own fixed step."""

from collections.abc import Callable
from functools import cache
from typing import Literal

import casadi as ca
import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.actuators import hydrostat_rates, pedal_rates, steering_rate, valve_rates
from drawbar.machine.chain import chain_rates
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.symbols import numbers, symbolic
from drawbar.vehicle.parameters import VehicleParameters

STATES = 11
"""x, y, theta, psi, joint (phi - psi), delta_t, wheel speed, and the four inner states of the drive"""
COMMANDS = 3
"""delta_t, joint, wheel speed"""
EFFECTS = 8
"""mu, kappa, b, alpha_r, alpha_i, and the kicks of a bump: to the left, of theta, of psi"""


def plant_constants(vehicle: VehicleParameters, settings: SimulatedMachineSettings) -> Floats:
    """Return all numbers of both sections in order, (c,): those of the plant among them."""
    return np.array([*numbers(vehicle), *numbers(settings)])


@cache
def plant_step(kind: Literal["lag", "valve"] = "lag") -> ca.Function:
    """Return one step F(state (11,), inputs (11,), constants (c,)) -> state (11,); inputs = (command, effect), held.

    The constants are those of plant_constants: data, so that the plant is compiled once for all of them. Of the kind
    "valve" a command is the drives of both valves and of the pedal's motor, and the state's last five are wheel speed,
    pedal, and the rates of both steerings and of the pedal.
    """
    stated = VehicleParameters(), SimulatedMachineSettings()
    state, inputs = ca.SX.sym("x", STATES), ca.SX.sym("i", COMMANDS + EFFECTS)
    constants = ca.SX.sym("c", len(plant_constants(*stated)))
    symbols = iter(ca.vertsplit(constants))
    vehicle, settings = symbolic(stated[0], symbols), symbolic(stated[1], symbols)
    actuation, step = _ACTUATIONS[kind], settings.step
    rates = _rates(vehicle, settings, constants, actuation)
    held = (inputs[:COMMANDS], inputs[COMMANDS:], constants)
    start = _kicked(state, held[1])
    k1 = rates(start, *held)
    k2 = rates(start + 0.5 * step * k1, *held)
    k3 = rates(start + 0.5 * step * k2, *held)
    k4 = rates(start + step * k3, *held)
    end = start + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    # the step in which an angle reaches its stop ends on the stop
    for index, stop in ((4, settings.actuators.trailer_stop), (5, settings.actuators.tractor_stop)):
        end[index] = ca.fmin(ca.fmax(end[index], -stop), stop)
    if kind == "valve":
        end[7] = ca.fmin(ca.fmax(end[7], 0.0), 1.0)
    return ca.Function("plant", [state, inputs, constants], [ca.cse(end)])


_Actuation = Callable[[VehicleParameters, SimulatedMachineSettings, ca.SX, ca.SX], tuple[ca.SX, ca.SX, ca.SX]]
"""from vehicle, settings, state and command to the rates of wheels and joint, and of the drive's five states"""


def _lag_actuation(
    vehicle: VehicleParameters, settings: SimulatedMachineSettings, state: ca.SX, command: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return what closed loops amount to."""
    actuators = settings.actuators
    lag = actuators.lag_factor * vehicle.steering_lag
    wheels_rate = steering_rate(state[5], command[0], lag=lag, rate=actuators.tractor_rate, stop=actuators.tractor_stop)
    joint_rate = steering_rate(state[4], command[1], lag=lag, rate=actuators.trailer_rate, stop=actuators.trailer_stop)
    return wheels_rate, joint_rate, hydrostat_rates(settings.hydrostat, state[6:], command[2])


def _valve_actuation(
    _vehicle: VehicleParameters, settings: SimulatedMachineSettings, state: ca.SX, command: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return the motion of valves and of the pedal's motor under their drives."""
    actuators, low_level = settings.actuators, settings.low_level
    motions = ca.vertcat(state[5], state[8]), ca.vertcat(state[4], state[9])
    front, joint = (
        valve_rates(valve, motion, drive, full_rate=rate, stop=stop)
        for valve, motion, drive, rate, stop in (
            (low_level.front, motions[0], command[0], actuators.tractor_rate, actuators.tractor_stop),
            (low_level.joint, motions[1], command[1], actuators.trailer_rate, actuators.trailer_stop),
        )
    )
    drive = pedal_rates(settings.hydrostat, ca.vertcat(state[6], state[7], state[10]), command[2], ca.SX(0.0))
    return front[0], joint[0], ca.vertcat(drive[0], drive[1], front[1], joint[1], drive[2])


_ACTUATIONS: dict[str, _Actuation] = {"lag": _lag_actuation, "valve": _valve_actuation}


def _rates(
    vehicle: VehicleParameters, settings: SimulatedMachineSettings, constants: ca.SX, actuation: _Actuation
) -> ca.Function:
    """Return the right-hand side f(state (11,), command (3,), effect (8,), constants (c,)) -> d state/dt (11,)."""
    state, command, effect = ca.SX.sym("x", STATES), ca.SX.sym("u", COMMANDS), ca.SX.sym("w", EFFECTS)
    wheels_rate, joint_rate, drive = actuation(vehicle, settings, state, command)
    speed, wheel_angle = effect[0] * state[6], effect[1] * state[5] + effect[2]
    chain = chain_rates(vehicle, state[:5], joint_rate, speed, wheel_angle, effect[3:5])
    return ca.Function("rates", [state, command, effect, constants], [ca.vertcat(chain, wheels_rate, drive)])


def _kicked(state: ca.SX, effect: ca.SX) -> ca.SX:
    """Apply the displacement of a bump, which takes no time."""
    theta = state[2]
    left = ca.vertcat(-ca.sin(theta), ca.cos(theta))
    pose = ca.vertcat(state[:2] + effect[5] * left, theta + effect[6], state[3] + effect[7])
    return ca.vertcat(pose, state[4:])
