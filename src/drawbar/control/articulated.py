"""The product's two nominal controllers: lateral errors of both antennas along a preview of the path."""

import cmath
import math

import numpy as np

from drawbar.control.actuator import SteeringActuator
from drawbar.control.chain import TrailerPoses, curvature_steering, steering_bounds
from drawbar.control.nominal_state import plain_deviation
from drawbar.control.off_tracking import SharedError
from drawbar.control.optimised_start import OptimisedStart
from drawbar.control.settings import ArticulatedControllerSettings, Coupling
from drawbar.control.subsystem import SubsystemController
from drawbar.control.tube.tube import SubsystemTube
from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem
from drawbar.signals import BodyPlan, BodyReference, Estimate
from drawbar.vehicle.articulated import articulated_tractor, articulated_trailer
from drawbar.vehicle.parameters import VehicleParameters


class ArticulatedTractor(SubsystemController):
    """Tractor with slip, crab and a steering of limited rate, held near the path's own curvature."""

    def __init__(
        self,
        vehicle: VehicleParameters,
        settings: ArticulatedControllerSettings,
        sample_time: float,
        tube: SubsystemTube,
    ) -> None:
        """Compile the controller for this vehicle, with what the tube leaves of the bounds."""
        weights = settings.tractor
        super().__init__(
            ControlProblem(
                model=articulated_tractor(vehicle),
                horizon=settings.horizon,
                sample_time=sample_time,
                weights=(weights.lateral, weights.heading, weights.steering, weights.steering_rate),
                terminal_weights=(weights.lateral, weights.heading, weights.steering, 0.0),
                bounds=_bounds(tube),
            ),
            tube,
        )
        self._vehicle = vehicle
        self._shared = SharedError(vehicle, settings.sharing, sample_time)
        self._actuator = SteeringActuator(
            lag=vehicle.steering_lag, limit=tube.bounds["command"].tightened, sample_time=sample_time
        )

    def _state(self, estimate: Estimate) -> Floats:
        pose = estimate.tractor
        return np.array([pose.x, pose.y, pose.yaw, estimate.tractor_steering])

    def _fill(self, estimate: Estimate, reference: BodyReference, neighbour: BodyPlan | None) -> None:
        solver, samples = self.solver, reference.samples
        solver.p[:, :5] = (
            estimate.longitudinal_slip,
            estimate.tractor_slip,
            estimate.steering_offset,
            estimate.tractor_crab,
            estimate.speed,
        )
        solver.p[:, 5:] = samples[:, :3]
        solver.y[:, 0] = self._shared.targets(estimate, samples[:, 3])
        solver.y[:, 2] = curvature_steering(self._vehicle, estimate, samples[:, 3])

    def _guess(self) -> None:
        """Linearise along the path itself, steered as its curvature asks."""
        solver = self.solver
        solver.x[:, :3], solver.x[:, 3], solver.u[:] = solver.p[:, 5:], solver.y[:, 2], 0.0
        solver.x[0] = solver.initial
        solver.prepare()

    def _steering(self) -> float:
        steering, rate = float(self.solver.x[0, 3]), float(self.solver.u[0, 0])
        command, self.solver.u[0, 0] = self._actuator.follow(steering, rate)
        return command

    def _steerings(self) -> Floats:
        return self.solver.x[1:, 3].copy()

    def _poses(self) -> Floats:
        return self.solver.x[:, :3].copy()


class ArticulatedTrailer(SubsystemController):
    """Trailer on the chain behind a tractor whose motion is given by the coupling."""

    def __init__(
        self,
        vehicle: VehicleParameters,
        settings: ArticulatedControllerSettings,
        sample_time: float,
        tube: SubsystemTube,
    ) -> None:
        """Compile the controller for this vehicle, with what the tube leaves of the bounds."""
        weights = settings.trailer
        super().__init__(
            ControlProblem(
                model=articulated_trailer(vehicle),
                horizon=settings.horizon,
                sample_time=sample_time,
                weights=(weights.lateral, weights.steering, weights.steering_rate),
                terminal_weights=(weights.lateral, weights.steering, 0.0),
                bounds=_bounds(tube),
            ),
            tube,
        )
        self._actuator = SteeringActuator(
            lag=vehicle.steering_lag,
            limit=tube.bounds["command"].tightened,
            sample_time=sample_time,
            sign=vehicle.joint_sign,
        )
        self._vehicle, self._coupling = vehicle, settings.coupling
        self._interval = sample_time
        self._times = sample_time * np.arange(settings.horizon + 1)
        self._imaginary_times = 1j * self._times[:-1]
        self._smoothing = -math.expm1(-sample_time / settings.yaw_rate_lag)
        self._yaw_rate = 0.0
        self._trailer_poses = TrailerPoses(vehicle, settings.horizon + 1)

    def _state(self, estimate: Estimate) -> Floats:
        return np.array([estimate.tractor.yaw - estimate.trailer.yaw, estimate.trailer_steering])

    def _enter(
        self, choice: OptimisedStart, estimate: Estimate, reference: BodyReference
    ) -> tuple[Estimate, BodyReference]:
        return estimate, reference  # the states are angles of the body itself

    def _beside(self, state: Floats, reference: BodyReference) -> Floats:
        return state

    def _deviation(self, estimated: Floats, nominal: Floats) -> Floats:
        return plain_deviation(estimated, nominal)

    def _fill(self, estimate: Estimate, reference: BodyReference, neighbour: BodyPlan | None) -> None:
        solver = self.solver
        solver.p[:, :4] = (
            estimate.longitudinal_slip,
            estimate.tractor_crab,
            estimate.trailer_crab,
            estimate.speed,
        )
        if self._coupling is Coupling.PLANNED and neighbour is not None:
            rates = np.diff(neighbour.poses[:, 2]) / self._interval
            solver.p[:-1, 4], solver.p[-1, 4] = rates, rates[-1]
            solver.p[:, 5:8] = neighbour.poses
        else:
            self._assume_tractor(estimate)
        solver.p[:, 8:] = reference.samples[:, :3]

    def _assume_tractor(self, estimate: Estimate) -> None:
        """Let the tractor keep its smoothed present yaw rate (measured coupling), or go straight (neglected)."""
        p, pose, crab = self.solver.p, estimate.tractor, estimate.tractor_crab
        speed = estimate.longitudinal_slip * estimate.speed
        if self._coupling is not Coupling.NEGLECTED:
            angle = estimate.tractor_slip * estimate.tractor_steering + estimate.steering_offset
            measured = speed * (math.tan(angle) - math.tan(crab)) / self._vehicle.wheelbase
            self._yaw_rate += self._smoothing * (measured - self._yaw_rate)
        omega = self._yaw_rate
        half = 0.5 * omega * self._interval
        # every sample covers the same chord, turned by one angle more
        chord = speed / math.cos(crab) * self._interval * (math.sin(half) / half if half else 1.0)
        first = cmath.rect(chord, pose.yaw + crab + half)
        turns = omega * self._times
        rotations = np.exp(omega * self._imaginary_times)
        p[:, 4] = omega
        p[0, 5:7] = pose.x, pose.y
        track = complex(pose.x, pose.y) + np.cumsum(first * rotations)
        p[1:, 5], p[1:, 6] = track.real, track.imag
        p[:, 7] = pose.yaw + turns

    def _steering(self) -> float:
        steering, rate = float(self.solver.x[0, 1]), float(self.solver.u[0, 0])
        command, self.solver.u[0, 0] = self._actuator.follow(steering, rate)
        return command

    def _steerings(self) -> Floats:
        return self.solver.x[1:, 1].copy()

    def _poses(self) -> Floats:
        p, x = self.solver.p, self.solver.x
        return self._trailer_poses.behind(p[:, 5:8], p[:, 7] - x[:, 0], x[:, 1])


def _bounds(tube: SubsystemTube) -> dict[str, Bound]:
    return steering_bounds(tube.bounds["steering"].tightened, tube.bounds["steering_rate"].tightened)
