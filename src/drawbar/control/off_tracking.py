"""Off-tracking: what both controllers need to share the trailer's (off_tracking.h)."""

import math

from drawbar.control.settings import SharingSettings
from drawbar.vehicle.parameters import VehicleParameters


def sharing_settings(vehicle: VehicleParameters, settings: SharingSettings, sample_time: float) -> dict[str, float]:
    """Return the lengths of the vehicle whose trailer's steering is at its limit, and how to share what that leaves.

    Args:
        vehicle: lengths and steering limit.
        settings: how to share.
        sample_time: between stages, s.
    """
    hitch, c, (ahead, left) = vehicle.free_joint_offset, vehicle.trailer_point, vehicle.tracked.tractor.arm
    along = vehicle.trailer_length + vehicle.drawbar_length * math.cos(vehicle.trailer_steering_limit)
    across = vehicle.drawbar_length * math.sin(vehicle.trailer_steering_limit)
    return {
        "shared.off_tracking.hitch": hitch + ahead,
        "shared.off_tracking.antenna": along - c,
        "shared.off_tracking.apart": vehicle.tracked.trailer.left - left,
        "shared.off_tracking.cut_in": 0.5 * (along**2 + across**2 - hitch**2 - c**2 + ahead**2),
        "shared.off_tracking.reach": across,
        "shared.share": settings.share,
        "shared.accepted_error": settings.accepted_error,
        "shared.widening": settings.widening,
        "shared.lag": vehicle.trailer_length + vehicle.drawbar_length,
        "shared.sample_time": sample_time,
    }
