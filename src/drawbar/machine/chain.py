"""Chain of tractor, drawbar and trailer: its exact nonholonomic motion, from the axles' rolling constraints alone.

Nothing here is shared with the controller's models: each yaw rate is the root of the (linear) condition that
an axle moves in the direction its wheels allow (docs/theory/vehicle-models.md).
"""

import casadi as ca

from drawbar.vehicle.parameters import VehicleParameters


def chain_rates(
    vehicle: VehicleParameters, pose: ca.SX, joint_rate: ca.SX, speed: ca.SX, wheel_angle: ca.SX, crabs: ca.SX
) -> ca.SX:
    """Return d/dt of pose = (x, y, theta, psi, joint), (5,): m/s and rad/s.

    joint = phi - psi; speed: of the tractor's rear axle along the tractor, m/s; wheel_angle: in which the
    front axle really moves against the tractor, rad; crabs (2,): side-slip of rear and trailer axle, rad.
    """
    theta, psi = pose[2], pose[3]
    rear = pose[:2]
    front = rear + vehicle.wheelbase * _direction(theta)
    rear_velocity = speed * _direction(theta) + speed * ca.tan(crabs[0]) * _normal(theta)

    tractor_rate, trailer_rate = ca.SX.sym("theta'"), ca.SX.sym("psi'")
    rates = ca.vertcat(rear_velocity, tractor_rate, trailer_rate, joint_rate)
    front_slides = _sliding(ca.jtimes(front, pose, rates), theta + wheel_angle)
    trailer_slides = _sliding(ca.jtimes(trailer_axle(vehicle, pose), pose, rates), psi + crabs[1])
    solved = _root(front_slides, tractor_rate)
    rates = ca.substitute(ca.substitute(rates, trailer_rate, _root(trailer_slides, trailer_rate)), tractor_rate, solved)
    return ca.cse(rates)


def trailer_axle(vehicle: VehicleParameters, pose: ca.SX) -> ca.SX:
    """Return the centre (2,) of the trailer's axle, m, for pose = (x, y, theta, psi, joint)."""
    theta, psi, phi = pose[2], pose[3], pose[3] + pose[4]
    free_joint = pose[:2] - vehicle.free_joint_offset * _direction(theta)
    actuated_joint = free_joint - vehicle.drawbar_length * _direction(phi)
    return actuated_joint - vehicle.trailer_length * _direction(psi)


def _direction(yaw: ca.SX) -> ca.SX:
    return ca.vertcat(ca.cos(yaw), ca.sin(yaw))


def _normal(yaw: ca.SX) -> ca.SX:
    return ca.vertcat(-ca.sin(yaw), ca.cos(yaw))


def _sliding(velocity: ca.SX, heading: ca.SX) -> ca.SX:
    """Velocity across the heading, m/s: zero for an axle that moves along it."""
    return ca.dot(velocity, _normal(heading))


def _root(residual: ca.SX, unknown: ca.SX) -> ca.SX:
    """Solve residual = 0, which is linear in the unknown."""
    return -ca.substitute(residual, unknown, 0.0) / ca.jacobian(residual, unknown)
