"""The product's centralised controller: lateral errors of both antennas on the whole chain."""

from drawbar.codegen import Unit
from drawbar.control.actuator import actuator_settings
from drawbar.control.centralised import centralised_unit
from drawbar.control.chain import chain_settings, steering_bounds
from drawbar.control.settings import ArticulatedControllerSettings
from drawbar.control.tube.tube import Tubes
from drawbar.optimal import Bound, ControlProblem
from drawbar.vehicle.articulated import articulated_tracking
from drawbar.vehicle.parameters import VehicleParameters


def centralised_articulated_unit(
    vehicle: VehicleParameters, settings: ArticulatedControllerSettings, sample_time: float, tubes: Tubes
) -> Unit:
    """Return costs, feed-forward and bounds of both decentralised controllers in one problem.

    No target is shifted here: where the trailer's steering is exhausted, the cost itself divides the error between both
    bodies.
    """
    tractor, trailer = settings.tractor, settings.trailer
    front, rear = (tractor.lateral, tractor.heading, tractor.steering), (trailer.lateral, trailer.steering)
    problem = ControlProblem(
        model=articulated_tracking(vehicle),
        horizon=settings.horizon,
        sample_time=sample_time,
        weights=(*front, tractor.steering_rate, *rear, trailer.steering_rate),
        terminal_weights=(*front, 0.0, *rear, 0.0),
        bounds=_bounds(tubes),
    )
    own = dict(chain_settings(vehicle))
    for body, tube, sign in (("tractor", tubes.tractor, 1), ("trailer", tubes.trailer, vehicle.joint_sign)):
        own |= actuator_settings(
            lag=vehicle.steering_lag,
            limit=tube.bounds["command"].tightened,
            sample_time=sample_time,
            sign=sign,
            place=f"{body}_actuator",
        )
    return centralised_unit("centralised_articulated.h", problem, tubes, own)


def _bounds(tubes: Tubes) -> dict[str, Bound]:
    front, rear = tubes.tractor.bounds, tubes.trailer.bounds
    return steering_bounds(front["steering"].tightened, front["steering_rate"].tightened, "tractor_") | steering_bounds(
        rear["steering"].tightened, rear["steering_rate"].tightened, "trailer_"
    )
