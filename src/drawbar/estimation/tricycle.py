"""Estimation on the paper's model."""

from drawbar.estimation.description import EstimationModel, by_variable, sensor_deviations
from drawbar.estimation.settings import TricycleEstimatorSettings
from drawbar.optimal import Bound, EstimationProblem
from drawbar.vehicle.chain import chain_settings
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise
from drawbar.vehicle.tricycle import tricycle

_SLIPS = ("longitudinal_slip", "tractor_slip", "trailer_slip")
_KEYS = (
    dict.fromkeys(("tractor_x", "tractor_y", "trailer_x", "trailer_y"), "position")
    | dict.fromkeys(("tractor_yaw", "trailer_yaw"), "yaw")
    | dict.fromkeys(_SLIPS, "slip")
    | {"hitch_angle": "hitch_angle", "speed": "speed"}
)
"""which value of a prior or drift section each state and parameter has"""


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
        self.constants = chain_settings(vehicle) | {
            "first_slip": settings.first_slip,
            "first_yaw_error": settings.first_yaw_error,
        }
        power = -1 if settings.weighting == "paper" else -2
        model = tricycle(vehicle)
        slip = Bound(lower=settings.slip_bounds.lower, upper=settings.slip_bounds.upper)
        self.problem = EstimationProblem(
            model=model,
            horizon=settings.window,
            sample_time=sample_time,
            weights={name: float(deviation**power) for name, deviation in sensor_deviations(noise).items()},
            prior_deviation=by_variable(settings.prior, _KEYS),
            process_deviation=by_variable(settings.drift, _KEYS),
            bounds=dict.fromkeys(_SLIPS, slip),
        )
