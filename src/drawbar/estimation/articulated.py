"""Estimation on the exact chain (the product's default)."""

from dataclasses import replace

import casadi as ca

from drawbar.estimation.description import EstimationModel, chain
from drawbar.estimation.settings import ArticulatedEstimatorSettings, SlipBounds
from drawbar.optimal import Bound, EstimationProblem
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.model import Model, variables
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import MEASURED, SensorNoise

_ORDER = (
    *("position", "position", "yaw", "yaw", "steering", "steering", "longitudinal_slip", "tractor_slip"),
    *("steering_offset", "crab", "speed", "crab"),
)
"""the problem's states and parameters, by the names of prior and drift"""
_ON_A_SLOPE = ("steering_offset", "crab")
"""what a side slope moves, all by the same angle"""


class ArticulatedEstimation(EstimationModel):
    """States x_t, y_t, theta, psi, delta_t, delta_i; parameters mu, kappa, b, alpha_i, v, alpha_r."""

    name = "articulated"

    def __init__(
        self,
        vehicle: VehicleParameters,
        noise: SensorNoise,
        settings: ArticulatedEstimatorSettings,
        sample_time: float,
    ) -> None:
        """Declare the window problem for this vehicle and these sensors."""
        self.screening, self.position_deviation = settings.screening, noise.position
        self.constants = chain(vehicle) | {
            "first_slip": settings.first_slip,
            "first_yaw_error": settings.first_yaw_error,
            "sample_time": sample_time,
            "steering_lag": vehicle.steering_lag,
            "tractor_rate": vehicle.tractor_steering_rate,
            "trailer_rate": vehicle.trailer_steering_rate,
            "joint_sign": vehicle.joint_sign,
        }
        rates = (settings.steering_rate,) * 2
        deviations = (
            *(noise.position,) * 4,
            noise.hitch_angle,
            noise.speed,
            noise.tractor_steering,
            noise.trailer_steering,
        )
        angle = Bound(lower=-settings.angle_bound, upper=settings.angle_bound)
        self.problem = EstimationProblem(
            model=_with_crab(articulated(vehicle)),
            horizon=settings.window,
            sample_time=sample_time,
            weights=tuple(deviation**-2 for deviation in (*deviations, *(settings.crab,) * 2, *rates)),
            prior_deviation=_ordered(settings.prior.model_dump()),
            process_deviation=_ordered(settings.drift.model_dump()),
            common_deviation=tuple(settings.drift.slope if name in _ON_A_SLOPE else 0.0 for name in _ORDER),
            bounds={
                "longitudinal_slip": _bound(settings.longitudinal_slip_bounds),
                "tractor_slip": _bound(settings.tractor_slip_bounds),
                "steering_offset": angle,
                "trailer_crab": angle,
                "tractor_crab": angle,
            },
        )


def _with_crab(model: Model) -> Model:
    """Return the model with both crab angles as outputs, before the rates: on the whole, axles do not slip sideways."""
    crab, split = variables(trailer_crab="rad", tractor_crab="rad"), len(MEASURED)
    return replace(
        model,
        outputs=(*model.outputs[:split], *crab, *model.outputs[split:]),
        output=ca.vertcat(model.output[:split], model.p[3], model.p[5], model.output[split:]),
    )


def _ordered(values: dict[str, float]) -> tuple[float, ...]:
    """Return a prior or drift section in the order of the problem's states and parameters."""
    return tuple(values[name] for name in _ORDER)


def _bound(bounds: SlipBounds) -> Bound:
    return Bound(lower=bounds.lower, upper=bounds.upper)
