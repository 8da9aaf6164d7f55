"""Estimation on the paper's model."""

from drawbar.estimation.description import EstimationModel, by_kind, chain
from drawbar.estimation.settings import TricycleEstimatorSettings
from drawbar.optimal import Bound, EstimationProblem
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise
from drawbar.vehicle.tricycle import tricycle

_SLIPS = ("longitudinal_slip", "tractor_slip", "trailer_slip")
_KINDS = {
    **dict.fromkeys(("tractor_x", "tractor_y", "trailer_x", "trailer_y"), "position"),
    **dict.fromkeys(("tractor_yaw", "trailer_yaw"), "yaw"),
    **dict.fromkeys(_SLIPS, "slip"),
}
"""how prior and drift call what has no name of its own there"""


class TricycleEstimation(EstimationModel):
    """States and parameters of the paper's model, see vehicle/tricycle.py; both steering angles are its inputs."""

    name = "tricycle"

    def __init__(
        self,
        vehicle: VehicleParameters,
        noise: SensorNoise,
        settings: TricycleEstimatorSettings,
        sample_time: float,
    ) -> None:
        """Declare the window problem for this vehicle and these sensors."""
        self.screening, self.position_deviation = settings.screening, noise.position
        self.constants = chain(vehicle) | {
            "first_slip": settings.first_slip,
            "first_yaw_error": settings.first_yaw_error,
        }
        deviations = (
            *(noise.position,) * 4,
            noise.hitch_angle,
            noise.speed,
            noise.tractor_steering,
            noise.trailer_steering,
        )
        power = -1 if settings.weighting == "paper" else -2
        model = tricycle(vehicle)
        slip = Bound(lower=settings.slip_bounds.lower, upper=settings.slip_bounds.upper)
        self.problem = EstimationProblem(
            model=model,
            horizon=settings.window,
            sample_time=sample_time,
            weights=tuple(float(deviation**power) for deviation in deviations),
            prior_deviation=by_kind(model, settings.prior.model_dump(), _KINDS),
            process_deviation=by_kind(model, settings.drift.model_dump(), _KINDS),
            bounds=dict.fromkeys(_SLIPS, slip),
        )
