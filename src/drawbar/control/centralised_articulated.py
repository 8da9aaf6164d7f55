"""The product's centralised controller: lateral errors of both antennas on the whole chain."""

from drawbar.control.actuator import actuator_settings
from drawbar.control.centralised import CentralisedController
from drawbar.control.chain import chain_settings, steering_bounds
from drawbar.control.settings import ArticulatedControllerSettings
from drawbar.control.tube.tube import Tubes
from drawbar.optimal import Bound, ControlProblem
from drawbar.vehicle.articulated import articulated_tracking
from drawbar.vehicle.parameters import VehicleParameters


class CentralisedArticulated(CentralisedController):
    """Costs, feed-forward and bounds of both decentralised controllers in one problem.

    No target is shifted here: where the trailer's steering is exhausted, the cost itself divides the error between both
    bodies.
    """

    def __init__(
        self, vehicle: VehicleParameters, settings: ArticulatedControllerSettings, sample_time: float, tubes: Tubes
    ) -> None:
        """Compile the controller for this vehicle, with what the tubes leave of the bounds."""
        tractor, trailer = settings.tractor, settings.trailer
        front, rear = (tractor.lateral, tractor.heading, tractor.steering), (trailer.lateral, trailer.steering)
        super().__init__(
            "centralised_articulated.h",
            ControlProblem(
                model=articulated_tracking(vehicle),
                horizon=settings.horizon,
                sample_time=sample_time,
                weights=(*front, tractor.steering_rate, *rear, trailer.steering_rate),
                terminal_weights=(*front, 0.0, *rear, 0.0),
                bounds=_bounds(tubes),
            ),
            tubes,
        )
        self.solver.workspace.write(chain_settings(vehicle))
        for body, tube, sign in (("tractor", tubes.tractor, 1), ("trailer", tubes.trailer, vehicle.joint_sign)):
            limit = tube.bounds["command"].tightened
            self.solver.workspace.write(
                actuator_settings(
                    lag=vehicle.steering_lag,
                    limit=limit,
                    sample_time=sample_time,
                    sign=sign,
                    place=f"{body}_actuator",
                )
            )


def _bounds(tubes: Tubes) -> dict[str, Bound]:
    front, rear = tubes.tractor.bounds, tubes.trailer.bounds
    return steering_bounds(front["steering"].tightened, front["steering_rate"].tightened, "tractor_") | steering_bounds(
        rear["steering"].tightened, rear["steering_rate"].tightened, "trailer_"
    )
