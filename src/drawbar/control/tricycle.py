"""The paper's two nominal controllers: positions tracked on the tricycle model."""

import numpy as np

from drawbar.control.settings import Coupling, TricycleControllerSettings
from drawbar.control.subsystem import SubsystemController
from drawbar.control.tube.tube import SubsystemTube
from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem
from drawbar.signals import BodyPlan, BodyReference, Estimate
from drawbar.vehicle.model import Model
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle_tractor, tricycle_trailer


def _problem(
    model: Model, settings: TricycleControllerSettings, sample_time: float, tube: SubsystemTube
) -> ControlProblem:
    q, s, limit = settings.position_weight, settings.terminal_weight, tube.bounds["command"].tightened
    return ControlProblem(
        model=model,
        horizon=settings.horizon,
        sample_time=sample_time,
        weights=(q, q, settings.steering_weight),
        terminal_weights=(s, s, 0.0),
        bounds={"steering": Bound(lower=-limit, upper=limit)},
    )


class _Tricycle(SubsystemController):
    """What both have in common: states are poses, the input is the steering angle itself."""

    def _steering(self) -> float:
        return float(self.solver.u[0, 0])

    def _steerings(self) -> Floats:
        return self.solver.u[:, 0].copy()

    def _poses(self) -> Floats:
        return self.solver.x.copy()


class TricycleTractor(_Tricycle):
    """Tractor: f_1 of the paper; the steering reference is the last measured angle."""

    def __init__(
        self,
        vehicle: VehicleParameters,
        settings: TricycleControllerSettings,
        sample_time: float,
        tube: SubsystemTube,
    ) -> None:
        """Compile the controller for this vehicle, with what the tube leaves of the bound."""
        super().__init__(_problem(tricycle_tractor(vehicle), settings, sample_time, tube), tube)

    def _state(self, estimate: Estimate) -> Floats:
        pose = estimate.tractor
        return np.array([pose.x, pose.y, pose.yaw])

    def _fill(self, estimate: Estimate, reference: BodyReference, neighbour: BodyPlan | None) -> None:
        solver = self.solver
        solver.p[:] = estimate.longitudinal_slip, estimate.tractor_slip, estimate.speed
        solver.y[:, :2] = reference.samples[:, :2]
        solver.y[:, 2] = estimate.tractor_steering


class TricycleTrailer(_Tricycle):
    """Trailer: f_2 of the paper, with g_2 as the coupling says."""

    def __init__(
        self,
        vehicle: VehicleParameters,
        settings: TricycleControllerSettings,
        sample_time: float,
        tube: SubsystemTube,
    ) -> None:
        """Compile the controller for this vehicle, with what the tube leaves of the bound."""
        super().__init__(_problem(tricycle_trailer(vehicle), settings, sample_time, tube), tube)
        self._coupling = settings.coupling
        self._leverage = vehicle.hitch_length / vehicle.wheelbase

    def _state(self, estimate: Estimate) -> Floats:
        pose = estimate.trailer
        return np.array([pose.x, pose.y, pose.yaw])

    def _fill(self, estimate: Estimate, reference: BodyReference, neighbour: BodyPlan | None) -> None:
        solver = self.solver
        solver.p[:, :4] = (
            estimate.longitudinal_slip,
            estimate.trailer_slip,
            estimate.hitch_angle,
            estimate.speed,
        )
        solver.p[:, 4] = self._pull(estimate, neighbour)
        solver.y[:, :2] = reference.samples[:, :2]
        solver.y[:, 2] = estimate.trailer_steering

    def _pull(self, estimate: Estimate, neighbour: BodyPlan | None) -> Floats | float:
        """Return l/L_t tan(kappa delta_t) over the horizon, as far as this controller knows it."""
        if self._coupling is Coupling.NEGLECTED:
            return 0.0
        if self._coupling is Coupling.MEASURED or neighbour is None:
            return self._leverage * float(np.tan(estimate.tractor_slip * estimate.tractor_steering))
        steerings = np.append(neighbour.steerings, neighbour.steerings[-1])
        return self._leverage * np.tan(estimate.tractor_slip * steerings)
