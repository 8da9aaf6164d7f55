"""Articulated model: the exact nonholonomic chain of tractor, drawbar and trailer with slip, and its two subsystems.

Geometry (docs/theory/conventions.md): the free joint RJ1 sits a behind the tractor's rear axle, the drawbar d
leads to the actuated joint RJ2, the trailer axle is L_i behind it. J is the actuated angle phi - psi.
"""

from dataclasses import replace
from typing import Any

import casadi as ca

from drawbar.vehicle.lengths import Lengths, lengths_of
from drawbar.vehicle.measured import MEASURED
from drawbar.vehicle.model import Model, by_name, declare, symbols, variables
from drawbar.vehicle.parameters import VehicleParameters


def trailer_yaw_rate(
    lengths: Lengths,
    speed: Any,
    omega: Any,
    gamma: Any,
    joint: Any,
    joint_rate: Any,
    crab: Any,
    trailer_crab: Any,
) -> Any:
    """Return psi', rad/s, such that the trailer axle's side-slip angle is trailer_crab.

    Args:
        lengths: of the vehicle.
        speed: V, longitudinal speed of the rear axle, m/s.
        omega: tractor yaw rate, rad/s.
        gamma: tractor yaw minus trailer yaw, rad.
        joint: J, rad.
        joint_rate: J', rad/s.
        crab: alpha_r, rad.
        trailer_crab: alpha_i, rad.
    """
    d, slope = lengths.drawbar_length, ca.tan(trailer_crab)
    lateral = speed * ca.tan(crab) - lengths.free_joint_offset * omega
    push = speed * ca.sin(gamma) + lateral * ca.cos(gamma) - d * joint_rate * ca.cos(joint)
    drag = speed * ca.cos(gamma) - lateral * ca.sin(gamma) + d * joint_rate * ca.sin(joint)
    lever = lengths.trailer_length + d * ca.cos(joint) + slope * d * ca.sin(joint)
    return (push - slope * drag) / lever


def trailer_antenna(lengths: Lengths, x: Any, y: Any, theta: Any, psi: Any, joint: Any) -> tuple[Any, Any]:
    """Return the trailer antenna's position (m) behind a tractor whose rear axle is at x, y (m); angles in rad."""
    a, d = lengths.free_joint_offset, lengths.drawbar_length
    back = lengths.trailer_length - lengths.trailer_antenna
    phi = psi + joint
    return (
        x - a * ca.cos(theta) - d * ca.cos(phi) - back * ca.cos(psi),
        y - a * ca.sin(theta) - d * ca.sin(phi) - back * ca.sin(psi),
    )


def tractor_rates(
    lengths: Lengths, theta: Any, steering: Any, mu: Any, kappa: Any, offset: Any, crab: Any, v: Any
) -> Any:
    """Return the column x', y' (m/s), theta' (rad/s) of the tractor.

    Args:
        lengths: of the vehicle.
        theta: tractor yaw, rad.
        steering: delta_t, rad.
        mu: longitudinal slip factor.
        kappa: factor on the steering angle.
        offset: b, rad.
        crab: alpha_r, rad.
        v: wheel speed, m/s.
    """
    speed, slide = mu * v, mu * v * ca.tan(crab)
    return ca.vertcat(
        speed * ca.cos(theta) - slide * ca.sin(theta),
        speed * ca.sin(theta) + slide * ca.cos(theta),
        speed * (ca.tan(kappa * steering + offset) - ca.tan(crab)) / lengths.wheelbase,
    )


def articulated(vehicle: VehicleParameters) -> Model:
    """Return the whole chain with the measured quantities, then both steering rates, as outputs.

    States x_t, y_t, theta, psi, delta_t, delta_i; inputs the steering rates; parameters mu, kappa, b, alpha_i, v,
    alpha_r. The hitch angle is an output: beta = theta - psi - delta_i.
    """
    lengths, constants = lengths_of(vehicle)

    def equations(x: Any, u: Any, p: Any) -> tuple[Any, Any]:
        x_t, y_t, theta, psi, delta_t, delta_i = ca.vertsplit(x)
        mu, kappa, offset, trailer_crab, v, crab = ca.vertsplit(p)
        tractor = tractor_rates(lengths, theta, delta_t, mu, kappa, offset, crab, v)
        psi_rate = trailer_yaw_rate(lengths, mu * v, tractor[2], theta - psi, delta_i, u[1], crab, trailer_crab)
        x_i, y_i = trailer_antenna(lengths, x_t, y_t, theta, psi, delta_i)
        output = ca.vertcat(x_t, y_t, x_i, y_i, theta - psi - delta_i, v, delta_t, delta_i, u)
        return ca.vertcat(tractor, psi_rate, u), output

    rates = variables(tractor_steering_rate="rad/s", trailer_steering_rate="rad/s")
    return declare(
        "articulated",
        states=variables(
            tractor_x="m",
            tractor_y="m",
            tractor_yaw="rad",
            trailer_yaw="rad",
            tractor_steering="rad",
            trailer_steering="rad",
        ),
        inputs=rates,
        parameters=variables(
            longitudinal_slip="1",
            tractor_slip="1",
            steering_offset="rad",
            trailer_crab="rad",
            speed="m/s",
            tractor_crab="rad",
        ),
        outputs=(*MEASURED, *rates),
        equations=equations,
        constants=constants,
    )


def articulated_tracking(vehicle: VehicleParameters) -> Model:
    """Return the whole chain with what both subsystems' costs weigh as outputs: for centralised control.

    States, inputs and first parameters are those of `articulated`; then come both reference poses x, y, yaw, the
    tractor's first. Outputs: those of `articulated_tractor`, then those of `articulated_trailer`.
    """
    chain = articulated(vehicle)
    references = variables(
        tractor_reference_x="m",
        tractor_reference_y="m",
        tractor_reference_yaw="rad",
        trailer_reference_x="m",
        trailer_reference_y="m",
        trailer_reference_yaw="rad",
    )
    known = symbols(references)
    x, u, p = by_name(chain.states, chain.x), by_name(chain.inputs, chain.u), by_name(chain.parameters, chain.p)
    at, reference = by_name(chain.outputs, chain.output), by_name(references, known)

    def lateral_error(body: str) -> Any:
        pose = (reference[f"{body}_reference_{coordinate}"] for coordinate in ("x", "y", "yaw"))
        return _lateral_error(at[f"{body}_x"], at[f"{body}_y"], *pose)

    return replace(
        chain,
        name="articulated_tracking",
        parameters=(*chain.parameters, *references),
        outputs=variables(
            tractor_lateral_error="m",
            tractor_heading_error="rad",
            tractor_steering="rad",
            tractor_steering_rate="rad/s",
            trailer_lateral_error="m",
            trailer_steering="rad",
            trailer_steering_rate="rad/s",
        ),
        p=ca.vertcat(chain.p, known),
        output=ca.vertcat(
            lateral_error("tractor"),
            x["tractor_yaw"] + p["tractor_crab"] - reference["tractor_reference_yaw"],
            x["tractor_steering"],
            u["tractor_steering_rate"],
            lateral_error("trailer"),
            x["trailer_steering"],
            u["trailer_steering_rate"],
        ),
    )


def articulated_tractor(vehicle: VehicleParameters) -> Model:
    """Return the tractor subsystem in path coordinates' outputs.

    States x, y, theta, delta_t; input the steering rate; parameters mu, kappa, b, alpha_r, v and the reference pose
    x, y, yaw. Outputs: lateral error (m), heading error of the direction of motion (rad), steering, steering rate.
    """
    lengths, constants = lengths_of(vehicle)

    def equations(x: Any, u: Any, p: Any) -> tuple[Any, Any]:
        px, py, theta, delta = ca.vertsplit(x)
        mu, kappa, offset, crab, v, rx, ry, yaw = ca.vertsplit(p)
        rates = tractor_rates(lengths, theta, delta, mu, kappa, offset, crab, v)
        errors = _lateral_error(px, py, rx, ry, yaw), theta + crab - yaw
        return ca.vertcat(rates, u), ca.vertcat(*errors, delta, u)

    return declare(
        "articulated_tractor",
        states=variables(x="m", y="m", yaw="rad", steering="rad"),
        inputs=variables(steering_rate="rad/s"),
        parameters=variables(
            longitudinal_slip="1",
            tractor_slip="1",
            steering_offset="rad",
            tractor_crab="rad",
            speed="m/s",
            reference_x="m",
            reference_y="m",
            reference_yaw="rad",
        ),
        outputs=variables(lateral_error="m", heading_error="rad", steering="rad", steering_rate="rad/s"),
        equations=equations,
        constants=constants,
    )


def articulated_trailer(vehicle: VehicleParameters) -> Model:
    """Return the trailer subsystem on the chain, with the tractor's motion as a known signal.

    States gamma = theta - psi and delta_i; input the steering rate; parameters mu, alpha_r, alpha_i, v, the tractor's
    yaw rate (the coupling), its pose at the stage, and the reference pose. Outputs: lateral error of the trailer
    antenna (m), steering, steering rate.
    """
    lengths, constants = lengths_of(vehicle)

    def equations(x: Any, u: Any, p: Any) -> tuple[Any, Any]:
        gamma, delta = ca.vertsplit(x)
        mu, crab, trailer_crab, v, omega, tx, ty, theta, rx, ry, yaw = ca.vertsplit(p)
        psi_rate = trailer_yaw_rate(lengths, mu * v, omega, gamma, delta, u, crab, trailer_crab)
        px, py = trailer_antenna(lengths, tx, ty, theta, theta - gamma, delta)
        return ca.vertcat(omega - psi_rate, u), ca.vertcat(_lateral_error(px, py, rx, ry, yaw), delta, u)

    return declare(
        "articulated_trailer",
        states=variables(articulation="rad", steering="rad"),
        inputs=variables(steering_rate="rad/s"),
        parameters=variables(
            longitudinal_slip="1",
            tractor_crab="rad",
            trailer_crab="rad",
            speed="m/s",
            tractor_yaw_rate="rad/s",
            tractor_x="m",
            tractor_y="m",
            tractor_yaw="rad",
            reference_x="m",
            reference_y="m",
            reference_yaw="rad",
        ),
        outputs=variables(lateral_error="m", steering="rad", steering_rate="rad/s"),
        equations=equations,
        constants=constants,
    )


def _lateral_error(x: Any, y: Any, reference_x: Any, reference_y: Any, reference_yaw: Any) -> Any:
    """Return the distance from the reference's tangent, left positive, m."""
    return ca.cos(reference_yaw) * (y - reference_y) - ca.sin(reference_yaw) * (x - reference_x)
