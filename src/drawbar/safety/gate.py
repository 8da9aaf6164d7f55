"""Gate: the last check of a command before it leaves, small and independent of all that made it (gate.h)."""

from numpy.typing import ArrayLike

from drawbar.codegen import Unit
from drawbar.vehicle.parameters import VehicleParameters

PATIENCE = 1.0
"""Time for which a command may act without a valid new one, s"""


def gate_unit(vehicle: VehicleParameters, *, speed_limit: float, sample_time: float) -> Unit:
    """Return the gate: it lets finite commands within the limits pass.

    Their steering passes no further from the wheels than where the actuator's valve is fully open. In place of any
    other command the gate repeats the last one that passed; when that has acted for PATIENCE, it stops the vehicle
    with its steering held where it was on average.

    Args:
        vehicle: limits, rates, lag and sign of the steering.
        speed_limit: m/s.
        sample_time: s.
    """
    settings: dict[str, ArrayLike] = {
        "limits": (vehicle.tractor_steering_limit, vehicle.trailer_steering_limit),
        "signs": (1.0, vehicle.joint_sign),
        "rates": (vehicle.tractor_steering_rate, vehicle.trailer_steering_rate),
        "lag": vehicle.steering_lag,
        "sample_time": sample_time,
        "speed_limit": speed_limit,
        "patience": PATIENCE,
        "repeats": max(round(PATIENCE / sample_time) - 1, 0),
    }
    return Unit(name="gate", source='#include "gate.h"', configure=lambda workspace: workspace.write(settings))
