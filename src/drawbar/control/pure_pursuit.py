"""Pure pursuit (R. C. Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, CMU-RI-TR-92-01, 1992)."""

import cmath
import math

import numpy as np

from drawbar.control.explicit import ExplicitController
from drawbar.control.settings import PurePursuitSettings
from drawbar.signals import BodyReference, Estimate
from drawbar.vehicle.parameters import VehicleParameters


class PurePursuit(ExplicitController):
    """Steers the rear axle along the arc that meets the path one look-ahead distance away.

    delta = atan(2 L_t sin(alpha) / l_d), alpha the bearing of that point. Neither slip nor the steering's lag is
    corrected for.
    """

    def __init__(self, vehicle: VehicleParameters, settings: PurePursuitSettings, sample_time: float) -> None:
        """Take the vehicle, look-ahead and gains, and the sample time, s."""
        super().__init__(vehicle, settings.trailer, sample_time)
        self._look_ahead = settings.look_ahead

    def _steering(self, estimate: Estimate, reference: BodyReference) -> float:
        pose = estimate.tractor
        to_goal = self._goal(reference) - complex(pose.x, pose.y)
        alpha = math.atan2(to_goal.imag, to_goal.real) - pose.yaw
        return math.atan2(2.0 * self._vehicle.wheelbase * math.sin(alpha), abs(to_goal))

    def _goal(self, reference: BodyReference) -> complex:
        """Return the pursued point of the path, east + i north (m).

        It lies on the arc that leaves the last sample before it; so the path also goes on where the samples end.
        """
        samples = reference.samples
        chords = np.hypot(*np.diff(samples[:, :2], axis=0).T)
        arc_length = np.concatenate([[0.0], chords.cumsum()])
        last = int(arc_length.searchsorted(self._look_ahead, "right")) - 1
        x, y, yaw, curvature = samples[last].tolist()
        beyond = self._look_ahead - float(arc_length[last])
        return complex(x, y) + cmath.rect(beyond, yaw + 0.5 * curvature * beyond)
