"""Alignment: measurements as sensors of the points on the ground would make them, all at one time (alignment.h)."""

from numpy.typing import ArrayLike

from drawbar.codegen import Unit
from drawbar.vehicle.chain import chain_settings
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

YAW_GATE = 0.1
"""Largest innovation of a yaw by two antennas, rad; a larger one is rejected"""
_RECORDED_LENGTHS = 1.5
"""How many lengths of the vehicle the record of the ground holds at least"""
_PLACES = 64
"""Records of the ground, as in ground_record.h"""


def alignment_unit(vehicle: VehicleParameters, sensors: SensorNoise, *, identifies: bool = True) -> Unit:
    """Return what brings positions from antennas to the ground, and all values to the time of the sample.

    Args:
        vehicle: its lengths and masts.
        sensors: how old and how far off fixes are.
        identifies: errors of hitch and joint are learned, since the estimate is no given truth.
    """
    fixes = sensors.fixes
    settings: dict[str, ArrayLike] = {
        **{
            f"positions.masts[ALIGNED_{body.upper()}].{name}": value
            for body, mast in vehicle.masts
            for name, value in mast.model_dump().items()
        },
        **{f"deviations.{name}": value for name, value in fixes.model_dump(exclude={"age"}).items()},
        **chain_settings(vehicle),
        "positions.to_axle": vehicle.trailer_antenna,
        "fix_age": fixes.age,
        "positions.fix_deviation": sensors.position,
        "yaw.gate": YAW_GATE,
        "identifies": float(identifies),
        "positions.ground.spacing": _RECORDED_LENGTHS * (vehicle.hitch_length + vehicle.trailer_length) / _PLACES,
    }
    return Unit(
        name="alignment", source='#include "alignment.h"', configure=lambda workspace: workspace.write(settings)
    )
