"""Explicit controllers, in closed form, to compare with: a steering law for the tractor, a PI law for the trailer."""

from collections.abc import Mapping

from numpy.typing import ArrayLike

from drawbar.codegen import Unit
from drawbar.control.settings import LqrSettings, PurePursuitSettings
from drawbar.vehicle.chain import chain_settings
from drawbar.vehicle.parameters import VehicleParameters


def explicit_unit(
    law: str,
    constants: Mapping[str, ArrayLike],
    vehicle: VehicleParameters,
    settings: PurePursuitSettings | LqrSettings,
    sample_time: float,
) -> Unit:
    """Return a controller that steers both bodies without a prediction (explicit.h).

    Its plan is what would follow if the command were held: the tractor rolls on at constant speed and curvature, the
    bicycle's, and the trailer is on its reference.

    Args:
        law: name of the header with the tractor's law.
        constants: of that law, by field.
        vehicle: lengths and limits.
        settings: horizon and the trailer's gains.
        sample_time: s.
    """
    own: dict[str, ArrayLike] = {
        **constants,
        **chain_settings(vehicle),
        "trailer.proportional": settings.trailer.proportional,
        "trailer.integral": settings.trailer.integral,
        "trailer.interval": sample_time,
        "trailer.limit": vehicle.trailer_steering_limit,
        "interval": sample_time,
        "limit": vehicle.tractor_steering_limit,
        "joint_sign": vehicle.joint_sign,
    }
    source = f'#define N {settings.horizon}\n#include "{law}.h"\n'
    return Unit(name="controller", source=source, configure=lambda workspace: workspace.write(own))
