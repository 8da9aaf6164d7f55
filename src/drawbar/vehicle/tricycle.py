"""Tricycle model, the paper's adaptive kinematic one (equations kinematicmodel and kinematicmodelDe), two subsystems.

Positions are those of the two antennas as the paper takes them; docs/theory/vehicle-models.md says what this model
gets wrong.
"""

from collections.abc import Callable
from typing import Any

import casadi as ca

from drawbar.vehicle.lengths import lengths_of
from drawbar.vehicle.measured import MEASURED
from drawbar.vehicle.model import Constant, Model, Variable, declare, variables
from drawbar.vehicle.parameters import VehicleParameters


def tricycle(vehicle: VehicleParameters) -> Model:
    """Return the whole paper model with the measured quantities as outputs.

    States x_t, y_t, theta, x_i, y_i, psi; inputs delta_t, delta_i; parameters mu, kappa, eta, beta, v.
    """
    lengths, constants = lengths_of(vehicle)

    def equations(x: Any, u: Any, p: Any) -> tuple[Any, Any]:
        x_t, y_t, theta, x_i, y_i, psi = ca.vertsplit(x)
        delta_t, delta_i = ca.vertsplit(u)
        mu, kappa, eta, beta, v = ca.vertsplit(p)
        pull = lengths.hitch_length / lengths.wheelbase * ca.tan(kappa * delta_t)
        derivative = ca.vertcat(
            mu * v * ca.cos(theta),
            mu * v * ca.sin(theta),
            mu * v * ca.tan(kappa * delta_t) / lengths.wheelbase,
            mu * v * ca.cos(psi),
            mu * v * ca.sin(psi),
            mu * v / lengths.trailer_length * (ca.sin(eta * delta_i + beta) - pull * ca.cos(eta * delta_i + beta)),
        )
        return derivative, ca.vertcat(x_t, y_t, x_i, y_i, beta, v, delta_t, delta_i)

    return declare(
        "tricycle",
        states=variables(
            tractor_x="m", tractor_y="m", tractor_yaw="rad", trailer_x="m", trailer_y="m", trailer_yaw="rad"
        ),
        inputs=variables(tractor_steering="rad", trailer_steering="rad"),
        parameters=variables(longitudinal_slip="1", tractor_slip="1", trailer_slip="1", hitch_angle="rad", speed="m/s"),
        outputs=MEASURED,
        equations=equations,
        constants=constants,
    )


def tricycle_tractor(vehicle: VehicleParameters) -> Model:
    """Return the tractor subsystem f_1: states x, y, theta; input delta_t; parameters mu, kappa, v."""
    lengths, constants = lengths_of(vehicle)
    parameters = variables(longitudinal_slip="1", tractor_slip="1", speed="m/s")

    def motion(delta: Any, mu: Any, kappa: Any, v: Any) -> tuple[Any, Any]:
        return mu * v, mu * v * ca.tan(kappa * delta) / lengths.wheelbase

    return _body("tricycle_tractor", parameters, motion, constants)


def tricycle_trailer(vehicle: VehicleParameters) -> Model:
    """Return the trailer subsystem f_2: states x, y, psi; input delta_i; parameters mu, eta, beta, v, coupling.

    The coupling is l/L_t tan(kappa delta_t) of g_2: zero where it is neglected, as in the paper.
    """
    lengths, constants = lengths_of(vehicle)
    parameters = variables(longitudinal_slip="1", trailer_slip="1", hitch_angle="rad", speed="m/s", coupling="1")

    def motion(delta: Any, mu: Any, eta: Any, beta: Any, v: Any, coupling: Any) -> tuple[Any, Any]:
        angle = eta * delta + beta
        return mu * v, mu * v / lengths.trailer_length * (ca.sin(angle) - coupling * ca.cos(angle))

    return _body("tricycle_trailer", parameters, motion, constants)


def _body(
    name: str, parameters: tuple[Variable, ...], motion: Callable[..., tuple[Any, Any]], constants: tuple[Constant, ...]
) -> Model:
    """Return the model of one body that moves along its own heading.

    The outputs are what the paper weighs: position and steering (its weight on yaw is zero).

    Args:
        name: of the model.
        parameters: of the motion.
        motion: ground speed (m/s) and yaw rate (rad/s) from the steering angle (rad) and the parameters.
        constants: that the motion may use.
    """

    def equations(x: Any, u: Any, p: Any) -> tuple[Any, Any]:
        speed, yaw_rate = motion(u[0], *ca.vertsplit(p))
        return ca.vertcat(speed * ca.cos(x[2]), speed * ca.sin(x[2]), yaw_rate), ca.vertcat(x[0], x[1], u[0])

    return declare(
        name,
        states=variables(x="m", y="m", yaw="rad"),
        inputs=variables(steering="rad"),
        parameters=parameters,
        outputs=variables(x="m", y="m", steering="rad"),
        equations=equations,
        constants=constants,
    )
