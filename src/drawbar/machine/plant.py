"""The simulated world over one sample period: chain, steering and drive, by RK4 at its own fixed step."""

from functools import cache

import casadi as ca
import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.actuators import hydrostat_rates, steering_rate
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
def plant_step() -> ca.Function:
    """Return one step F(state (11,), inputs (11,), constants (c,)) -> state (11,); inputs = (command, effect), held.

    The constants are those of plant_constants: data, so that the plant is compiled once for all of them.
    """
    stated = VehicleParameters(), SimulatedMachineSettings()
    state, inputs = ca.SX.sym("x", STATES), ca.SX.sym("i", COMMANDS + EFFECTS)
    constants = ca.SX.sym("c", len(plant_constants(*stated)))
    symbols = iter(ca.vertsplit(constants))
    vehicle, settings = symbolic(stated[0], symbols), symbolic(stated[1], symbols)
    rates, step = _rates(vehicle, settings, constants), settings.step
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
    return ca.Function("plant", [state, inputs, constants], [ca.cse(end)])


def _rates(vehicle: VehicleParameters, settings: SimulatedMachineSettings, constants: ca.SX) -> ca.Function:
    """Return the right-hand side f(state (11,), command (3,), effect (8,), constants (c,)) -> d state/dt (11,)."""
    state, command, effect = ca.SX.sym("x", STATES), ca.SX.sym("u", COMMANDS), ca.SX.sym("w", EFFECTS)
    actuators = settings.actuators
    lag = actuators.lag_factor * vehicle.steering_lag
    wheels_rate = steering_rate(state[5], command[0], lag=lag, rate=actuators.tractor_rate, stop=actuators.tractor_stop)
    joint_rate = steering_rate(state[4], command[1], lag=lag, rate=actuators.trailer_rate, stop=actuators.trailer_stop)
    speed, wheel_angle = effect[0] * state[6], effect[1] * state[5] + effect[2]
    chain = chain_rates(vehicle, state[:5], joint_rate, speed, wheel_angle, effect[3:5])
    drive = hydrostat_rates(settings.hydrostat, state[6:], command[2])
    return ca.Function("rates", [state, command, effect, constants], [ca.vertcat(chain, wheels_rate, drive)])


def _kicked(state: ca.SX, effect: ca.SX) -> ca.SX:
    """Apply the displacement of a bump, which takes no time."""
    theta = state[2]
    left = ca.vertcat(-ca.sin(theta), ca.cos(theta))
    pose = ca.vertcat(state[:2] + effect[5] * left, theta + effect[6], state[3] + effect[7])
    return ca.vertcat(pose, state[4:])
