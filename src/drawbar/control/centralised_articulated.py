"""The product's centralised controller: lateral errors of both antennas on the whole chain."""

import numpy as np

from drawbar.control.actuator import SteeringActuator
from drawbar.control.centralised import CentralisedController
from drawbar.control.chain import TrailerPoses, curvature_steering, steering_bounds
from drawbar.control.nominal_state import beside, plain_deviation, pose_deviation
from drawbar.control.settings import ArticulatedControllerSettings
from drawbar.control.tube.tube import Tubes
from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem
from drawbar.signals import Estimate, Reference
from drawbar.vehicle.articulated import articulated_tracking
from drawbar.vehicle.parameters import VehicleParameters

_TRACTOR = [0, 1, 2, 4]
"""where the tractor's own states x, y, theta, delta_t are among all"""


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
        self._vehicle = vehicle
        self._actuators = tuple(
            SteeringActuator(
                lag=vehicle.steering_lag, limit=tube.bounds["command"].tightened, sample_time=sample_time, sign=sign
            )
            for tube, sign in ((tubes.tractor, 1), (tubes.trailer, vehicle.joint_sign))
        )
        self._trailer_poses = TrailerPoses(vehicle, settings.horizon + 1)

    def _state(self, estimate: Estimate) -> Floats:
        tractor = estimate.tractor
        steerings = estimate.tractor_steering, estimate.trailer_steering
        return np.array([tractor.x, tractor.y, tractor.yaw, estimate.trailer.yaw, *steerings])

    def _fill(self, estimate: Estimate, reference: Reference) -> None:
        solver, tractor, trailer = self.solver, reference.tractor.samples, reference.trailer.samples
        solver.p[:, :6] = (
            estimate.longitudinal_slip,
            estimate.tractor_slip,
            estimate.steering_offset,
            estimate.trailer_crab,
            estimate.speed,
            estimate.tractor_crab,
        )
        solver.p[:, 6:9], solver.p[:, 9:] = tractor[:, :3], trailer[:, :3]
        solver.y[:, 2] = curvature_steering(self._vehicle, estimate, tractor[:, 3])

    def _guess(self) -> None:
        """Linearise along the path itself, the tractor steered as its curvature asks, the trailer straight."""
        solver = self.solver
        solver.x[:, :3], solver.x[:, 3] = solver.p[:, 6:9], solver.p[:, 11]
        solver.x[:, 4], solver.x[:, 5], solver.u[:] = solver.y[:, 2], 0.0, 0.0
        solver.x[0] = solver.initial
        solver.prepare()

    def _steering(self) -> tuple[float, float]:
        return self._command(0), self._command(1)

    def _command(self, body: int) -> float:
        u, steering = self.solver.u, float(self.solver.x[0, 4 + body])
        command, u[0, body] = self._actuators[body].follow(steering, float(u[0, body]))
        return command

    def _steerings(self) -> Floats:
        return self.solver.x[1:, 4:].copy()

    def _poses(self) -> tuple[Floats, Floats]:
        x = self.solver.x
        return x[:, :3].copy(), self._trailer_poses.behind(x[:, :3], x[:, 3], x[:, 5])

    def _deviations(self, estimated: Floats, predicted: Floats, reference: Reference) -> tuple[Floats, Floats]:
        tractor = pose_deviation(estimated[_TRACTOR], beside(predicted[_TRACTOR], reference.tractor.closest))
        return tractor, plain_deviation(_trailer_state(estimated), _trailer_state(predicted))


def _trailer_state(x: Floats) -> Floats:
    """Return the trailer's own states gamma, delta_i."""
    return np.array([x[2] - x[3], x[5]])


def _bounds(tubes: Tubes) -> dict[str, Bound]:
    front, rear = tubes.tractor.bounds, tubes.trailer.bounds
    return steering_bounds(front["steering"].tightened, front["steering_rate"].tightened, "tractor_") | steering_bounds(
        rear["steering"].tightened, rear["steering_rate"].tightened, "trailer_"
    )
