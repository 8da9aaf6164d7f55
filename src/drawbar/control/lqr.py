"""Linear quadratic regulator in path coordinates (Snider 2009, Automatic Steering Methods, CMU-RI-TR-09-08)."""

import numpy as np
from scipy.linalg import solve_discrete_are

from drawbar.control.explicit import ExplicitController
from drawbar.control.settings import LqrSettings
from drawbar.geometry import Floats
from drawbar.vehicle.parameters import VehicleParameters


class LinearQuadraticRegulator(ExplicitController):
    """Feeds lateral and heading error back on top of the steering that holds the path's curvature.

    With small errors e (lateral) and h (heading), v the steering beyond the feed-forward: e' = V h, h' = V / L_t v. The
    gain belongs to the set speed V. The feed-forward is the product's: it knows the estimated slips. The lateral error
    counts no further than where it is balanced by the steepest approach.
    """

    def __init__(self, vehicle: VehicleParameters, settings: LqrSettings, sample_time: float, speed: float) -> None:
        """Take the vehicle, weights and gains, the sample time (s) and the set speed (m/s)."""
        A, B = path_dynamics(speed, vehicle.wheelbase, sample_time)
        self.gain: Floats = regulator_gain(
            A, B, Q=np.diag([settings.lateral, settings.heading]), R=np.array([[settings.steering]])
        )
        """(1, 2) K: steering is minus K times the errors, rad/m and rad/rad"""
        first, second = self.gain[0].tolist()
        constants = {
            "law.gain": self.gain[0],
            "law.lead": settings.lead / sample_time,
            "law.furthest": second / first * settings.approach_angle,  # errors whose steering balances: K (e, h) = 0
        }
        super().__init__("lqr", constants, vehicle, settings, sample_time)


def path_dynamics(speed: float, wheelbase: float, sample_time: float) -> tuple[Floats, Floats]:
    """Return A (2, 2) and B (2, 1) of lateral and heading error over one sample with constant steering."""
    drive, turn = speed * sample_time, speed * sample_time / wheelbase
    return np.array([[1.0, drive], [0.0, 1.0]]), np.array([[0.5 * drive * turn], [turn]])


def regulator_gain(A: Floats, B: Floats, Q: Floats, R: Floats) -> Floats:
    """Return K (nu, nx) such that u = -K x minimises the sum of x'Qx + u'Ru under x+ = A x + B u."""
    P = solve_discrete_are(A, B, Q, R)
    gain: Floats = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
    return gain
