"""Actuator: numbers of a lagging actuator that a controller needs (actuator.h)."""

import math

from drawbar.control.tube.tube import SubsystemTube


def actuator_settings(
    tube: SubsystemTube, *, lag: float, sample_time: float, sign: int = 1, place: str = "actuator"
) -> dict[str, float]:
    """Return the settings of a first-order lag delta' = (u - delta) / tau, whose command u is held over a sample.

    Args:
        tube: what it leaves of command and rate.
        lag: tau, s.
        sample_time: s.
        sign: -1 if the actuator is reversed.
        place: name of the C struct.
    """
    lead = sample_time / (1.0 - math.exp(-sample_time / lag))
    rate = tube.bounds["steering_rate"]
    return {
        f"{place}.lead": lead,
        f"{place}.limit": tube.bounds["command"].tightened,
        f"{place}.rate_share": rate.tightened / rate.original,
        f"{place}.sign": sign,
    }
