"""Linear quadratic regulator in path coordinates (Snider 2009, Automatic Steering Methods, CMU-RI-TR-09-08)."""

import numpy as np
from numpy.linalg import LinAlgError

from drawbar.codegen import Unit
from drawbar.control.explicit import explicit_unit
from drawbar.control.matrix_equations import regulator_gain
from drawbar.control.settings import LqrSettings
from drawbar.errors import ConfigurationError
from drawbar.geometry import Floats
from drawbar.vehicle.parameters import VehicleParameters


def lqr_unit(vehicle: VehicleParameters, settings: LqrSettings, sample_time: float, speed: float) -> Unit:
    """Return the regulator: lateral and heading error fed back on top of the steering that holds the path's curvature.

    With small errors e (lateral) and h (heading), v the steering beyond the feed-forward: e' = V h, h' = V / L_t v. The
    gain belongs to the set speed V (m/s). The feed-forward is the product's: it uses the estimated slips. The lateral
    error counts no further than where it is balanced by the steepest approach.
    """
    gain = lqr_gain(vehicle, settings, sample_time, speed)
    first, second = gain[0].tolist()
    constants = {
        "law.gain": gain[0],
        "law.lead": settings.lead / sample_time,
        "law.furthest": second / first * settings.approach_angle,  # errors whose steering balances: K (e, h) = 0
    }
    return explicit_unit("lqr", constants, vehicle, settings, sample_time)


def lqr_gain(vehicle: VehicleParameters, settings: LqrSettings, sample_time: float, speed: float) -> Floats:
    """Return (1, 2) K: the steering is minus K times lateral and heading error, rad/m and rad/rad.

    Raises:
        ConfigurationError: the weights have no regulator.
    """
    A, B = path_dynamics(speed, vehicle.wheelbase, sample_time)
    try:
        return regulator_gain(A, B, Q=np.diag([settings.lateral, settings.heading]), R=np.array([[settings.steering]]))
    except LinAlgError as error:
        raise ConfigurationError(
            f"controller.lateral = {settings.lateral}, heading = {settings.heading} and steering = "
            f"{settings.steering} have no regulator ({error}); give weights that differ by fewer orders of magnitude"
        ) from error


def path_dynamics(speed: float, wheelbase: float, sample_time: float) -> tuple[Floats, Floats]:
    """Return A (2, 2) and B (2, 1) of lateral and heading error over one sample with constant steering."""
    drive, turn = speed * sample_time, speed * sample_time / wheelbase
    return np.array([[1.0, drive], [0.0, 1.0]]), np.array([[0.5 * drive * turn], [turn]])
