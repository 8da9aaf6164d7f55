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
_THETA, _PSI, _JOINT, _WHEELS, _SPEED = range(2, 7)
_PEDAL, _WHEELS_RATE, _JOINT_RATE, _PEDAL_RATE = range(7, STATES)
"""the inner states, where valves and a pedal are simulated"""
COMMANDS = 3
"""delta_t, joint, wheel speed"""
EFFECTS = 8
"""mu, kappa, b, alpha_r, alpha_i, and the kicks of a bump: to the left, of theta, of psi"""
_KICKS = 5
"""the first of them"""


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
    for index, stop in ((_JOINT, settings.actuators.trailer_stop), (_WHEELS, settings.actuators.tractor_stop)):
        end[index] = ca.fmin(ca.fmax(end[index], -stop), stop)
    if kind == "valve":
        end[_PEDAL] = ca.fmin(ca.fmax(end[_PEDAL], 0.0), 1.0)
    return ca.Function("plant", [state, inputs, constants], [ca.cse(end)])


_Actuation = Callable[[VehicleParameters, SimulatedMachineSettings, ca.SX, ca.SX], tuple[ca.SX, ca.SX, ca.SX]]
"""from vehicle, settings, state and command to the rates of wheels and joint, and of the drive's five states"""


def _lag_actuation(
    vehicle: VehicleParameters, settings: SimulatedMachineSettings, state: ca.SX, command: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return what closed loops amount to."""
    actuators, (front, joint, speed) = settings.actuators, ca.vertsplit(command)
    lag = actuators.lag_factor * vehicle.steering_lag
    wheels_rate = steering_rate(
        state[_WHEELS], front, lag=lag, rate=actuators.tractor_rate, stop=actuators.tractor_stop
    )
    joint_rate = steering_rate(state[_JOINT], joint, lag=lag, rate=actuators.trailer_rate, stop=actuators.trailer_stop)
    return wheels_rate, joint_rate, hydrostat_rates(settings.hydrostat, state[_SPEED:], speed)


def _valve_actuation(
    _vehicle: VehicleParameters, settings: SimulatedMachineSettings, state: ca.SX, command: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return the motion of valves and of the pedal's motor under their drives."""
    actuators, low_level = settings.actuators, settings.low_level
    front_drive, joint_drive, pedal_drive = ca.vertsplit(command)
    wheels_rate, wheels_acceleration = ca.vertsplit(
        valve_rates(
            low_level.front,
            ca.vertcat(state[_WHEELS], state[_WHEELS_RATE]),
            front_drive,
            full_rate=actuators.tractor_rate,
            stop=actuators.tractor_stop,
        )
    )
    joint_rate, joint_acceleration = ca.vertsplit(
        valve_rates(
            low_level.joint,
            ca.vertcat(state[_JOINT], state[_JOINT_RATE]),
            joint_drive,
            full_rate=actuators.trailer_rate,
            stop=actuators.trailer_stop,
        )
    )
    pedal = ca.vertcat(state[_SPEED], state[_PEDAL], state[_PEDAL_RATE])
    acceleration, pedal_rate, pedal_acceleration = ca.vertsplit(
        pedal_rates(settings.hydrostat, pedal, pedal_drive, ca.SX(0.0))
    )
    inner = ca.vertcat(acceleration, pedal_rate, wheels_acceleration, joint_acceleration, pedal_acceleration)
    return wheels_rate, joint_rate, inner


_ACTUATIONS: dict[str, _Actuation] = {"lag": _lag_actuation, "valve": _valve_actuation}


def _rates(
    vehicle: VehicleParameters, settings: SimulatedMachineSettings, constants: ca.SX, actuation: _Actuation
) -> ca.Function:
    """Return the right-hand side f(state (11,), command (3,), effect (8,), constants (c,)) -> d state/dt (11,)."""
    state, command, effect = ca.SX.sym("x", STATES), ca.SX.sym("u", COMMANDS), ca.SX.sym("w", EFFECTS)
    wheels_rate, joint_rate, drive = actuation(vehicle, settings, state, command)
    mu, kappa, offset, *crabs = ca.vertsplit(effect[:_KICKS])
    speed, wheel_angle = mu * state[_SPEED], kappa * state[_WHEELS] + offset
    chain = chain_rates(vehicle, state[: _JOINT + 1], joint_rate, speed, wheel_angle, ca.vertcat(*crabs))
    return ca.Function("rates", [state, command, effect, constants], [ca.vertcat(chain, wheels_rate, drive)])


def _kicked(state: ca.SX, effect: ca.SX) -> ca.SX:
    """Apply the displacement of a bump, which takes no time."""
    theta, (leftwards, tractor_turn, trailer_turn) = state[_THETA], ca.vertsplit(effect[_KICKS:])
    left = ca.vertcat(-ca.sin(theta), ca.cos(theta))
    pose = ca.vertcat(state[:_THETA] + leftwards * left, theta + tractor_turn, state[_PSI] + trailer_turn)
    return ca.vertcat(pose, state[_JOINT:])
