"""The product's two nominal controllers: lateral errors of both antennas along a preview of the path."""

import math

from drawbar.control.actuator import actuator_settings
from drawbar.control.chain import chain_settings, steering_bounds
from drawbar.control.off_tracking import sharing_settings
from drawbar.control.settings import ArticulatedControllerSettings
from drawbar.control.subsystem import SubsystemController, coupling_settings
from drawbar.control.tube.tube import SubsystemTube
from drawbar.optimal import Bound, ControlProblem
from drawbar.vehicle.articulated import articulated_tractor, articulated_trailer
from drawbar.vehicle.parameters import VehicleParameters


class ArticulatedTractor(SubsystemController):
    """Tractor with slip, crab and a steering of limited rate, held near the path's own curvature."""

    def __init__(
        self,
        vehicle: VehicleParameters,
        settings: ArticulatedControllerSettings,
        sample_time: float,
        tube: SubsystemTube,
    ) -> None:
        """Compile the controller for this vehicle, with what the tube leaves of the bounds."""
        weights = settings.tractor
        errors = {
            "lateral_error": weights.lateral,
            "heading_error": weights.heading,
            "steering": weights.steering,
        }
        super().__init__(
            ControlProblem(
                model=articulated_tractor(vehicle),
                horizon=settings.horizon,
                sample_time=sample_time,
                weights=errors | {"steering_rate": weights.steering_rate},
                terminal_weights=errors,
                bounds=_bounds(tube),
            ),
            tube,
            "articulated_tractor.h",
            chain_settings(vehicle)
            | actuator_settings(
                lag=vehicle.steering_lag, limit=tube.bounds["command"].tightened, sample_time=sample_time
            )
            | sharing_settings(vehicle, settings.sharing, sample_time),
        )


class ArticulatedTrailer(SubsystemController):
    """Trailer on the chain behind a tractor whose motion is given by the coupling."""

    def __init__(
        self,
        vehicle: VehicleParameters,
        settings: ArticulatedControllerSettings,
        sample_time: float,
        tube: SubsystemTube,
    ) -> None:
        """Compile the controller for this vehicle, with what the tube leaves of the bounds."""
        weights = settings.trailer
        errors = {"lateral_error": weights.lateral, "steering": weights.steering}
        super().__init__(
            ControlProblem(
                model=articulated_trailer(vehicle),
                horizon=settings.horizon,
                sample_time=sample_time,
                weights=errors | {"steering_rate": weights.steering_rate},
                terminal_weights=errors,
                bounds=_bounds(tube),
            ),
            tube,
            "articulated_trailer.h",
            chain_settings(vehicle)
            | actuator_settings(
                lag=vehicle.steering_lag,
                limit=tube.bounds["command"].tightened,
                sample_time=sample_time,
                sign=vehicle.joint_sign,
            )
            | coupling_settings(settings.coupling)
            | {
                "interval": sample_time,
                "smoothing": -math.expm1(-sample_time / settings.yaw_rate_lag),
            },
        )


def _bounds(tube: SubsystemTube) -> dict[str, Bound]:
    return steering_bounds(tube.bounds["steering"].tightened, tube.bounds["steering_rate"].tightened)
