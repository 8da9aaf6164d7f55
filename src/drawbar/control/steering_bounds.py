"""Steering bounds that the controllers on the chain share."""

from drawbar.optimal import Bound

_OVERSTEER = 1e3
"""Penalty per radian on a planned steering angle beyond its limit: soft, since the estimate may lie beyond it."""


def steering_bounds(limit: float, rate: float, body: str = "") -> dict[str, Bound]:
    """Return the soft bound on a steering angle (rad) and the hard one on its rate (rad/s), by the model's names."""
    return {
        f"{body}steering": Bound(lower=-limit, upper=limit, linear_penalty=_OVERSTEER),
        f"{body}steering_rate": Bound(lower=-rate, upper=rate),
    }
