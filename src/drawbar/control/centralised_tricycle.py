"""The paper's centralised controller (CeNMPC): both positions tracked on the whole tricycle model."""

import numpy as np

from drawbar.control.centralised import CentralisedController
from drawbar.control.nominal_state import beside, pose_deviation
from drawbar.control.settings import TricycleControllerSettings
from drawbar.control.tube.tube import Tubes
from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem
from drawbar.signals import Estimate, Reference
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle


class CentralisedTricycle(CentralisedController):
    """Costs Q, R, S of both bodies; steering references are the last measured angles, as in the decentralised pair."""

    def __init__(
        self, vehicle: VehicleParameters, settings: TricycleControllerSettings, sample_time: float, tubes: Tubes
    ) -> None:
        """Compile the controller for this vehicle, with what the tubes leave of the bounds."""
        q, s, r = settings.position_weight, settings.terminal_weight, settings.steering_weight
        front, rear = (tube.bounds["command"].tightened for tube in (tubes.tractor, tubes.trailer))
        super().__init__(
            ControlProblem(
                model=tricycle(vehicle),
                horizon=settings.horizon,
                sample_time=sample_time,
                weights=(q, q, q, q, 0.0, 0.0, r, r),  # hitch angle and speed are given
                terminal_weights=(s, s, s, s, 0.0, 0.0, 0.0, 0.0),
                bounds={
                    "tractor_steering": Bound(lower=-front, upper=front),
                    "trailer_steering": Bound(lower=-rear, upper=rear),
                },
            ),
            tubes,
        )

    def _state(self, estimate: Estimate) -> Floats:
        tractor, trailer = estimate.tractor, estimate.trailer
        return np.array([tractor.x, tractor.y, tractor.yaw, trailer.x, trailer.y, trailer.yaw])

    def _fill(self, estimate: Estimate, reference: Reference) -> None:
        solver = self.solver
        solver.p[:] = (
            estimate.longitudinal_slip,
            estimate.tractor_slip,
            estimate.trailer_slip,
            estimate.hitch_angle,
            estimate.speed,
        )
        solver.y[:, :2] = reference.tractor.samples[:, :2]
        solver.y[:, 2:4] = reference.trailer.samples[:, :2]
        solver.y[:, 6:] = estimate.tractor_steering, estimate.trailer_steering

    def _guess(self) -> None:
        """Linearise along standing still."""
        self.solver.start()

    def _steering(self) -> tuple[float, float]:
        tractor, trailer = self.solver.u[0].tolist()
        return tractor, trailer

    def _steerings(self) -> Floats:
        return self.solver.u.copy()

    def _poses(self) -> tuple[Floats, Floats]:
        x = self.solver.x.copy()
        return x[:, :3], x[:, 3:]

    def _deviations(self, estimated: Floats, predicted: Floats, reference: Reference) -> tuple[Floats, Floats]:
        return (
            pose_deviation(estimated[:3], beside(predicted[:3], reference.tractor.closest)),
            pose_deviation(estimated[3:], beside(predicted[3:], reference.trailer.closest)),
        )
