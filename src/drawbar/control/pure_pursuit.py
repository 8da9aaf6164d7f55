"""Pure pursuit (R. C. Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, CMU-RI-TR-92-01, 1992)."""

from drawbar.codegen import Unit
from drawbar.control.explicit import explicit_unit
from drawbar.control.settings import PurePursuitSettings
from drawbar.vehicle.parameters import VehicleParameters


def pure_pursuit_unit(vehicle: VehicleParameters, settings: PurePursuitSettings, sample_time: float) -> Unit:
    """Return the controller that steers the rear axle along the arc that meets the path one look-ahead distance away.

    delta = atan(2 L_t sin(alpha) / l_d), alpha the bearing of that point. Neither slip nor the steering's lag is
    corrected for.
    """
    return explicit_unit("pure_pursuit", {"law.look_ahead": settings.look_ahead}, vehicle, settings, sample_time)
