"""Chain: steering bounds and lengths that the controllers on the chain share (chain.h)."""

from drawbar.optimal import Bound
from drawbar.vehicle.parameters import VehicleParameters

_OVERSTEER = 1e3
"""Penalty per radian on a planned steering angle beyond its limit: soft, since the estimate may lie beyond it."""


def steering_bounds(limit: float, rate: float, body: str = "") -> dict[str, Bound]:
    """Return the soft bound on a steering angle (rad) and the hard one on its rate (rad/s), by the model's names."""
    return {
        f"{body}steering": Bound(lower=-limit, upper=limit, linear_penalty=_OVERSTEER),
        f"{body}steering_rate": Bound(lower=-rate, upper=rate),
    }


def chain_settings(vehicle: VehicleParameters) -> dict[str, float]:
    """Return the lengths that chain.h knows, m."""
    return {
        "chain.wheelbase": vehicle.wheelbase,
        "chain.hitch": vehicle.free_joint_offset,
        "chain.drawbar": vehicle.drawbar_length,
        "chain.back": vehicle.trailer_length - vehicle.trailer_antenna,
    }
