"""Estimation on the exact chain (the product's default)."""

from dataclasses import replace

import casadi as ca

from drawbar.estimation.description import EstimationModel, by_kind, chain
from drawbar.estimation.settings import ArticulatedEstimatorSettings, SlipBounds
from drawbar.optimal import Bound, EstimationProblem
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.model import Model, by_name, variables
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import MEASURED, SensorNoise

_CRAB = {"trailer_crab": "rad", "tractor_crab": "rad"}
_KINDS = {
    **dict.fromkeys(("tractor_x", "tractor_y"), "position"),
    **dict.fromkeys(("tractor_yaw", "trailer_yaw"), "yaw"),
    **dict.fromkeys(("tractor_steering", "trailer_steering"), "steering"),
    **dict.fromkeys(_CRAB, "crab"),
}
"""how prior and drift call what has no name of its own there"""
_ON_A_SLOPE = ("steering_offset", *_CRAB)
"""what a side slope moves, all by the same angle"""


class ArticulatedEstimation(EstimationModel):
    """States and parameters of the chain, see vehicle/articulated.py; the steering rates are its inputs."""

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
        model = _with_crab(articulated(vehicle))
        angle = Bound(lower=-settings.angle_bound, upper=settings.angle_bound)
        self.problem = EstimationProblem(
            model=model,
            horizon=settings.window,
            sample_time=sample_time,
            weights=tuple(deviation**-2 for deviation in (*deviations, *(settings.crab,) * 2, *rates)),
            prior_deviation=by_kind(model, settings.prior.model_dump(), _KINDS),
            process_deviation=by_kind(model, settings.drift.model_dump(), _KINDS),
            common_deviation=tuple(
                settings.drift.slope if name in _ON_A_SLOPE else 0.0 for name in (*model.names["X"], *model.names["P"])
            ),
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
    crab, known, split = variables(**_CRAB), by_name(model.parameters, model.p), len(MEASURED)
    return replace(
        model,
        outputs=(*model.outputs[:split], *crab, *model.outputs[split:]),
        output=ca.vertcat(model.output[:split], *(known[name] for name in _CRAB), model.output[split:]),
    )


def _bound(bounds: SlipBounds) -> Bound:
    return Bound(lower=bounds.lower, upper=bounds.upper)
