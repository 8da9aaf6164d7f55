"""The exact nonholonomic chain of tractor, drawbar and trailer with slip, and its two subsystems.

Geometry (theory.md sections 2 and 3.2): the free joint RJ1 sits a behind the tractor's rear axle, the drawbar d
leads to the actuated joint RJ2, the trailer axle is L_i behind it. J is the actuated angle phi - psi.
"""

from typing import Any

import casadi as ca

from drawbar.vehicle.model import Model, symbols, variables
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import MEASURED


def trailer_yaw_rate(
    vehicle: VehicleParameters,
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
        vehicle: lengths.
        speed: V, longitudinal speed of the rear axle, m/s.
        omega: tractor yaw rate, rad/s.
        gamma: tractor yaw minus trailer yaw, rad.
        joint: J, rad.
        joint_rate: J', rad/s.
        crab: alpha_r, rad.
        trailer_crab: alpha_i, rad.
    """
    d, slope = vehicle.drawbar_length, ca.tan(trailer_crab)
    lateral = speed * ca.tan(crab) - vehicle.free_joint_offset * omega
    push = speed * ca.sin(gamma) + lateral * ca.cos(gamma) - d * joint_rate * ca.cos(joint)
    drag = speed * ca.cos(gamma) - lateral * ca.sin(gamma) + d * joint_rate * ca.sin(joint)
    lever = vehicle.trailer_length + d * ca.cos(joint) + slope * d * ca.sin(joint)
    return (push - slope * drag) / lever


def trailer_antenna(vehicle: VehicleParameters, x: Any, y: Any, theta: Any, psi: Any, joint: Any) -> tuple[Any, Any]:
    """Return the trailer antenna's position (m) behind a tractor whose rear axle is at x, y (m); angles in rad."""
    a, d = vehicle.free_joint_offset, vehicle.drawbar_length
    back = vehicle.trailer_length - vehicle.trailer_antenna
    phi = psi + joint
    return (
        x - a * ca.cos(theta) - d * ca.cos(phi) - back * ca.cos(psi),
        y - a * ca.sin(theta) - d * ca.sin(phi) - back * ca.sin(psi),
    )


def articulated(vehicle: VehicleParameters) -> Model:
    """Return the whole chain with the measured quantities, then both steering rates, as outputs.

    States x_t, y_t, theta, psi, delta_t, delta_i; inputs the steering rates; parameters mu, kappa, b, alpha_i, v,
    alpha_r. The hitch angle is an output: beta = theta - psi - delta_i.
    """
    states = variables(
        tractor_x="m",
        tractor_y="m",
        tractor_yaw="rad",
        trailer_yaw="rad",
        tractor_steering="rad",
        trailer_steering="rad",
    )
    inputs = variables(tractor_steering_rate="rad/s", trailer_steering_rate="rad/s")
    parameters = variables(
        longitudinal_slip="1",
        tractor_slip="1",
        steering_offset="rad",
        trailer_crab="rad",
        speed="m/s",
        tractor_crab="rad",
    )
    outputs = (*MEASURED, *variables(tractor_steering_rate="rad/s", trailer_steering_rate="rad/s"))
    x, u, p = symbols(states), symbols(inputs), symbols(parameters)
    x_t, y_t, theta, psi, delta_t, delta_i = ca.vertsplit(x)
    mu, kappa, offset, trailer_crab, v, crab = ca.vertsplit(p)
    speed = mu * v
    omega = speed * (ca.tan(kappa * delta_t + offset) - ca.tan(crab)) / vehicle.wheelbase
    slide = speed * ca.tan(crab)
    derivative = ca.vertcat(
        speed * ca.cos(theta) - slide * ca.sin(theta),
        speed * ca.sin(theta) + slide * ca.cos(theta),
        omega,
        trailer_yaw_rate(vehicle, speed, omega, theta - psi, delta_i, u[1], crab, trailer_crab),
        u,
    )
    x_i, y_i = trailer_antenna(vehicle, x_t, y_t, theta, psi, delta_i)
    return Model(
        name="articulated",
        states=states,
        inputs=inputs,
        parameters=parameters,
        outputs=outputs,
        x=x,
        u=u,
        p=p,
        derivative=derivative,
        output=ca.vertcat(x_t, y_t, x_i, y_i, theta - psi - delta_i, v, delta_t, delta_i, u),
    )


def articulated_tractor(vehicle: VehicleParameters) -> Model:
    """Return the tractor subsystem in path coordinates' outputs.

    States x, y, theta, delta_t; input the steering rate; parameters mu, kappa, b, alpha_r, v and the reference pose
    x, y, yaw. Outputs: lateral error (m), heading error of the direction of motion (rad), steering, steering rate.
    """
    states = variables(x="m", y="m", yaw="rad", steering="rad")
    inputs = variables(steering_rate="rad/s")
    parameters = variables(
        longitudinal_slip="1",
        tractor_slip="1",
        steering_offset="rad",
        tractor_crab="rad",
        speed="m/s",
        reference_x="m",
        reference_y="m",
        reference_yaw="rad",
    )
    x, u, p = symbols(states), symbols(inputs), symbols(parameters)
    px, py, theta, delta = ca.vertsplit(x)
    mu, kappa, offset, crab, v, rx, ry, yaw = ca.vertsplit(p)
    speed, slide = mu * v, mu * v * ca.tan(crab)
    return Model(
        name="articulated_tractor",
        states=states,
        inputs=inputs,
        parameters=parameters,
        outputs=variables(lateral_error="m", heading_error="rad", steering="rad", steering_rate="rad/s"),
        x=x,
        u=u,
        p=p,
        derivative=ca.vertcat(
            speed * ca.cos(theta) - slide * ca.sin(theta),
            speed * ca.sin(theta) + slide * ca.cos(theta),
            speed * (ca.tan(kappa * delta + offset) - ca.tan(crab)) / vehicle.wheelbase,
            u,
        ),
        output=ca.vertcat(_lateral_error(px, py, rx, ry, yaw), theta + crab - yaw, delta, u),
    )


def articulated_trailer(vehicle: VehicleParameters) -> Model:
    """Return the trailer subsystem on the chain, with the tractor's motion as a known signal.

    States gamma = theta - psi and delta_i; input the steering rate; parameters mu, alpha_r, alpha_i, v, the tractor's
    yaw rate (the coupling), its pose at the stage, and the reference pose. Outputs: lateral error of the trailer
    antenna (m), steering, steering rate.
    """
    states = variables(articulation="rad", steering="rad")
    inputs = variables(steering_rate="rad/s")
    parameters = variables(
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
    )
    x, u, p = symbols(states), symbols(inputs), symbols(parameters)
    gamma, delta = ca.vertsplit(x)
    mu, crab, trailer_crab, v, omega, tx, ty, theta, rx, ry, yaw = ca.vertsplit(p)
    px, py = trailer_antenna(vehicle, tx, ty, theta, theta - gamma, delta)
    return Model(
        name="articulated_trailer",
        states=states,
        inputs=inputs,
        parameters=parameters,
        outputs=variables(lateral_error="m", steering="rad", steering_rate="rad/s"),
        x=x,
        u=u,
        p=p,
        derivative=ca.vertcat(omega - trailer_yaw_rate(vehicle, mu * v, omega, gamma, delta, u, crab, trailer_crab), u),
        output=ca.vertcat(_lateral_error(px, py, rx, ry, yaw), delta, u),
    )


def _lateral_error(x: Any, y: Any, reference_x: Any, reference_y: Any, reference_yaw: Any) -> Any:
    """Return the distance from the reference's tangent, left positive, m."""
    return ca.cos(reference_yaw) * (y - reference_y) - ca.sin(reference_yaw) * (x - reference_x)
