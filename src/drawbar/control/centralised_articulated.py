"""The product's centralised controller: lateral errors of both antennas on the whole chain."""

from drawbar.codegen import Unit
from drawbar.control.actuator import actuator_settings
from drawbar.control.centralised import centralised_unit
from drawbar.control.settings import ArticulatedControllerSettings
from drawbar.control.steering_bounds import steering_bounds
from drawbar.control.tube.tube import Tubes
from drawbar.optimal import Bound, ControlProblem
from drawbar.vehicle.articulated import articulated_tracking
from drawbar.vehicle.chain import chain_settings
from drawbar.vehicle.parameters import VehicleParameters


def centralised_articulated_unit(
    vehicle: VehicleParameters, settings: ArticulatedControllerSettings, sample_time: float, tubes: Tubes
) -> Unit:
    """Return costs, feed-forward and bounds of both decentralised controllers in one problem.

    No target is shifted here: where the trailer's steering is exhausted, the cost itself divides the error between both
    bodies.
    """
    tractor, trailer = settings.tractor, settings.trailer
    errors = {
        "tractor_lateral_error": tractor.lateral,
        "tractor_heading_error": tractor.heading,
        "tractor_steering": tractor.steering,
        "trailer_lateral_error": trailer.lateral,
        "trailer_steering": trailer.steering,
    }
    rates = {"tractor_steering_rate": tractor.steering_rate, "trailer_steering_rate": trailer.steering_rate}
    problem = ControlProblem(
        model=articulated_tracking(vehicle),
        horizon=settings.horizon,
        sample_time=sample_time,
        weights=errors | rates,
        terminal_weights=errors,
        bounds=_bounds(tubes),
    )
    own = {**chain_settings(vehicle), "rate_weight": tractor.steering_rate}
    for body, tube, sign in (("tractor", tubes.tractor, 1), ("trailer", tubes.trailer, vehicle.joint_sign)):
        own |= actuator_settings(
            tube, lag=vehicle.steering_lag, sample_time=sample_time, sign=sign, place=f"{body}_actuator"
        )
    return centralised_unit("centralised_articulated.h", problem, tubes, own)


def _bounds(tubes: Tubes) -> dict[str, Bound]:
    front, rear = tubes.tractor.bounds, tubes.trailer.bounds
    return steering_bounds(front["steering"].tightened, front["steering_rate"].tightened, "tractor_") | steering_bounds(
        rear["steering"].tightened, rear["steering_rate"].tightened, "trailer_"
    )
