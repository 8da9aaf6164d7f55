"""State of the multibody in the words of the kinematic chain, and how its axles slide."""

import math
from typing import NamedTuple

from drawbar.vehicle.parameters import VehicleParameters

ROLLING = 0.1
"""below this speed an axle's direction of motion means nothing, m/s"""


class State(NamedTuple):
    """The machine after one step; yaws stand where History looks for them."""

    tractor_x: float
    tractor_y: float
    tractor_yaw: float
    trailer_yaw: float
    trailer_x: float
    trailer_y: float
    tractor_z: float
    trailer_z: float
    tractor_roll: float
    tractor_pitch: float
    trailer_roll: float
    trailer_pitch: float
    hitch_angle: float
    joint: float
    steering: float
    speed: float


class Slides(NamedTuple):
    """How much the wheels slide."""

    longitudinal_slip: float
    """mu, speed over ground per wheel speed"""
    steering_offset: float
    """b, direction of motion of the front axle's middle beyond the front wheels' angle, rad"""
    tractor_crab: float
    """alpha_r, rad"""
    trailer_crab: float
    """alpha_i, rad"""


def slides(state: State, before: State, duration: float, vehicle: VehicleParameters) -> Slides:
    """Return how the wheels slid between two states (s apart); nothing for a vehicle that stands."""
    ahead, sideways, turn = _motion(state, before, "tractor", duration)
    if not abs(ahead) > ROLLING:
        return Slides(1.0, 0.0, 0.0, 0.0)
    front = math.atan((sideways + vehicle.wheelbase * turn) / ahead)
    trailer_ahead, trailer_sideways, trailer_turn = _motion(state, before, "trailer", duration)
    rolls = abs(state.speed) > ROLLING
    return Slides(
        longitudinal_slip=ahead / state.speed if rolls else 1.0,
        steering_offset=front - state.steering,
        tractor_crab=math.atan(sideways / ahead),
        trailer_crab=math.atan2(trailer_sideways - vehicle.trailer_antenna * trailer_turn, abs(trailer_ahead)),
    )


def _motion(state: State, before: State, body: str, duration: float) -> tuple[float, float, float]:
    """Return a body's mean speed along and across itself, m/s, and its yaw rate, rad/s."""
    x, y, yaw = (
        (getattr(state, f"{body}_{name}") - getattr(before, f"{body}_{name}")) / duration for name in ("x", "y", "yaw")
    )
    heading = getattr(state, f"{body}_yaw") - 0.5 * duration * yaw
    cos, sin = math.cos(heading), math.sin(heading)
    return x * cos + y * sin, y * cos - x * sin, yaw
