"""A tyre on the ground: a spring that carries, and bristles that hold, slip and slide.

The wheel is a disc on the plane that touches the ground beneath it. Its bristles are bent by what the tread slides over
the ground, and unbend as far as the contact yields to their force:

    u' = -v - y F / (c N),    F = k u + d u',    k = c N / s,    |F| <= mu N,    y = max(|w r|, c creep V)

On firm ground y = |w r|: in steady rolling F = -c N (slip, slip angle), up to friction, built up over the relaxation
length s (Pacejka, "Tire and vehicle dynamics", ch. 7: single contact point transient tyre models). Soft ground creeps
by creep V F / N, beneath a carcass, k and d, that is as stiff as on firm ground. With V = |w r|, as on soil, the slip
angle is creep F / N at any speed, built up over s / (c creep), and at rest F is a spring's: a vehicle on a slope stands
still. With a constant V, as in a contact with viscous friction, the slip angle falls with the speed, and a vehicle at
rest on a slope slides.
"""

from typing import NamedTuple

import casadi as ca

_BRISTLE_DAMPING = 0.02
"""d per k, s"""
_ROLLING = 0.2
"""from about this angular velocity on rolling resistance is complete, rad/s"""


class Wheel(NamedTuple):
    """Where one wheel is, how it moves, and what it stands on."""

    centre: ca.SX
    """(3,) m"""
    axis: ca.SX
    """(3,) unit, to the left"""
    velocity: ca.SX
    """(3,) of the centre, m/s"""
    turning: ca.SX
    """(3,) angular velocity, rad/s"""
    plane: ca.SX
    """(3,) of the ground beneath it: height at the origin (m), slopes to the east and to the north"""
    radius: ca.SX


class Tyre(NamedTuple):
    """One tyre's numbers, or symbols in their place."""

    stiffness: float
    """vertical, N/m"""
    damping: float
    """vertical, N s/m"""
    cornering: float
    """c, on firm ground, 1/rad"""
    creep: float
    """of the ground"""
    creep_speed: float
    """V, m/s; 0: as fast as the wheel rolls"""
    friction: float
    relaxation: float
    rolling_resistance: float


def contact(wheel: Wheel, tyre: Tyre, bristles: ca.SX, step: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return what the ground does to one wheel during a step: bristles (2,) m after it, force (3,) N, torque (3,) Nm.

    Args:
        wheel: its state.
        tyre: its numbers.
        bristles: (2,) bent forward and to the left, m.
        step: s, by which the bristles move on.
    """
    normal = _unit(ca.vertcat(-wheel.plane[1], -wheel.plane[2], 1.0))
    forward = _unit(ca.cross(wheel.axis, normal))
    left = ca.cross(normal, forward)
    arm = wheel.radius * _unit(-(normal - ca.dot(normal, wheel.axis) * wheel.axis))
    point = wheel.centre + arm
    above = normal[2] * (point[2] - wheel.plane[0] - wheel.plane[1] * point[0] - wheel.plane[2] * point[1])
    slide = wheel.velocity + ca.cross(wheel.turning, arm)
    load = ca.fmax(ca.if_else(above < 0.0, -tyre.stiffness * above - tyre.damping * ca.dot(slide, normal), 0.0), 0.0)
    spin = ca.dot(wheel.turning, wheel.axis)
    sliding = ca.vertcat(ca.dot(slide, forward), ca.dot(slide, left))
    bent, held = _bristles(tyre, bristles, sliding, ca.fabs(spin) * wheel.radius, load, step)
    force = load * normal + held[0] * forward + held[1] * left
    brake = tyre.rolling_resistance * load * wheel.radius * ca.tanh(spin / _ROLLING)
    return bent, force, ca.cross(arm, force) - brake * wheel.axis


def _bristles(
    tyre: Tyre, bristles: ca.SX, sliding: ca.SX, rolling: ca.SX, load: ca.SX, step: ca.SX
) -> tuple[ca.SX, ca.SX]:
    """Return the bristles after a step (2,), m, and their force (2,), N; both within friction."""
    creeping = tyre.creep * ca.if_else(tyre.creep_speed > 0.0, tyre.creep_speed, rolling)
    yielding = ca.fmax(rolling, tyre.cornering * creeping)
    unbending = yielding / tyre.relaxation
    bent = (bristles * (1.0 + _BRISTLE_DAMPING * unbending) - step * sliding) / (
        1.0 + (_BRISTLE_DAMPING + step) * unbending
    )
    stiffness = tyre.cornering * load / tyre.relaxation
    force = stiffness * (bent + _BRISTLE_DAMPING * (bent - bristles) / step)
    reach = tyre.friction * tyre.relaxation / tyre.cornering
    touching = load > 0.0
    bent = ca.if_else(touching, bent * ca.fmin(1.0, reach / _length(bent)), 0.0)
    return bent, force * ca.fmin(1.0, tyre.friction * load / _length(force))


def _unit(vector: ca.SX) -> ca.SX:
    return vector / ca.norm_2(vector)


def _length(vector: ca.SX) -> ca.SX:
    """Return the length, never zero, of a vector."""
    return ca.sqrt(ca.sumsqr(vector) + 1e-18)
