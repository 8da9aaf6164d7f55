"""Estimation on the paper's model."""

from drawbar.estimation.description import EstimationModel, chain
from drawbar.estimation.settings import TricycleEstimatorSettings
from drawbar.optimal import Bound, EstimationProblem
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise
from drawbar.vehicle.tricycle import tricycle


class TricycleEstimation(EstimationModel):
    """States x_t, y_t, theta, x_i, y_i, psi; parameters mu, kappa, eta, beta, v; both steering angles are inputs."""

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
        slip = Bound(lower=settings.slip_bounds.lower, upper=settings.slip_bounds.upper)
        self.problem = EstimationProblem(
            model=tricycle(vehicle),
            horizon=settings.window,
            sample_time=sample_time,
            weights=tuple(float(deviation**power) for deviation in deviations),
            prior_deviation=_ordered(settings.prior.model_dump()),
            process_deviation=_ordered(settings.drift.model_dump()),
            bounds=dict.fromkeys(("longitudinal_slip", "tractor_slip", "trailer_slip"), slip),
        )


def _ordered(values: dict[str, float]) -> tuple[float, ...]:
    """Return a prior or drift section in the order of the problem's states and parameters."""
    order = (
        "position",
        "position",
        "yaw",
        "position",
        "position",
        "yaw",
        "slip",
        "slip",
        "slip",
        "hitch_angle",
        "speed",
    )
    return tuple(values[name] for name in order)
