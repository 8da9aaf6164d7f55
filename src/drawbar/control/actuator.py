"""Actuator: numbers of a lagging actuator that a controller must know (actuator.h)."""

import math


def actuator_settings(
    *, lag: float, limit: float, sample_time: float, sign: int = 1, place: str = "actuator"
) -> dict[str, float]:
    """Return the settings of a first-order lag delta' = (u - delta) / tau, whose command u is held over a sample.

    Args:
        lag: tau, s.
        limit: largest command, rad.
        sample_time: s.
        sign: -1 if the actuator is reversed.
        place: name of the C struct.
    """
    lead = sample_time / (1.0 - math.exp(-sample_time / lag))
    return {f"{place}.lead": lead, f"{place}.limit": limit, f"{place}.sign": sign}
