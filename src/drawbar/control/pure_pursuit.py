"""Pure pursuit (R. C. Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, CMU-RI-TR-92-01, 1992)."""

from drawbar.control.explicit import ExplicitController
from drawbar.control.settings import PurePursuitSettings
from drawbar.vehicle.parameters import VehicleParameters


class PurePursuit(ExplicitController):
    """Steers the rear axle along the arc that meets the path one look-ahead distance away.

    delta = atan(2 L_t sin(alpha) / l_d), alpha the bearing of that point. Neither slip nor the steering's lag is
    corrected for.
    """

    def __init__(self, vehicle: VehicleParameters, settings: PurePursuitSettings, sample_time: float) -> None:
        """Take the vehicle, look-ahead and gains, and the sample time, s."""
        super().__init__("pure_pursuit", {"law.look_ahead": settings.look_ahead}, vehicle, settings, sample_time)
