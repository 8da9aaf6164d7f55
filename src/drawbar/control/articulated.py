"""The product's two nominal controllers: lateral errors of both antennas along a preview of the path."""

import math

import numpy as np

from drawbar.control.actuator import SteeringActuator
from drawbar.control.settings import ArticulatedControllerSettings, Coupling
from drawbar.control.subsystem import SubsystemController
from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem
from drawbar.signals import BodyPlan, BodyReference, Estimate
from drawbar.vehicle.articulated import articulated_tractor, articulated_trailer
from drawbar.vehicle.parameters import VehicleParameters

_OVERSTEER = 1e3
"""Penalty per radian on a planned steering angle beyond its limit: soft, since the estimate may lie beyond it."""


class ArticulatedTractor(SubsystemController):
    """Tractor with slip, crab and a steering of limited rate, held near the path's own curvature."""

    def __init__(self, vehicle: VehicleParameters, settings: ArticulatedControllerSettings, sample_time: float) -> None:
        """Compile the controller for this vehicle."""
        weights, limit = settings.tractor, vehicle.tractor_steering_limit
        super().__init__(
            ControlProblem(
                model=articulated_tractor(vehicle),
                horizon=settings.horizon,
                sample_time=sample_time,
                weights=(weights.lateral, weights.heading, weights.steering, weights.steering_rate),
                terminal_weights=(weights.lateral, weights.heading, weights.steering, 0.0),
                bounds=_steering_bounds(limit, vehicle.tractor_steering_rate),
            )
        )
        self._wheelbase = vehicle.wheelbase
        self._widening = settings.widening
        self._actuator = SteeringActuator(lag=vehicle.steering_lag, limit=limit, sample_time=sample_time)

    def _fill(self, estimate: Estimate, reference: BodyReference, neighbour: BodyPlan | None) -> None:
        solver, pose, samples = self.solver, estimate.tractor, reference.samples
        solver.initial[:] = pose.x, pose.y, pose.yaw, estimate.tractor_steering
        solver.p[:, :5] = (
            estimate.longitudinal_slip,
            estimate.tractor_slip,
            estimate.steering_offset,
            estimate.tractor_crab,
            estimate.speed,
        )
        solver.p[:, 5:] = samples[:, :3]
        solver.y[:, 0] = -self._widening * samples[:, 3]
        slope = self._wheelbase * samples[:, 3] + math.tan(estimate.tractor_crab)
        solver.y[:, 2] = (np.arctan(slope) - estimate.steering_offset) / estimate.tractor_slip

    def _steering(self) -> float:
        return self._actuator.command(float(self.solver.initial[3]), float(self.solver.u[0, 0]))

    def _steerings(self) -> Floats:
        return self.solver.x[1:, 3].copy()

    def _poses(self) -> Floats:
        return self.solver.x[:, :3].copy()


class ArticulatedTrailer(SubsystemController):
    """Trailer on the chain behind a tractor whose motion is given by the coupling."""

    def __init__(self, vehicle: VehicleParameters, settings: ArticulatedControllerSettings, sample_time: float) -> None:
        """Compile the controller for this vehicle."""
        weights, limit = settings.trailer, vehicle.trailer_steering_limit
        super().__init__(
            ControlProblem(
                model=articulated_trailer(vehicle),
                horizon=settings.horizon,
                sample_time=sample_time,
                weights=(weights.lateral, weights.steering, weights.steering_rate),
                terminal_weights=(weights.lateral, weights.steering, 0.0),
                bounds=_steering_bounds(limit, vehicle.trailer_steering_rate),
            )
        )
        self._actuator = SteeringActuator(
            lag=vehicle.steering_lag, limit=limit, sample_time=sample_time, sign=vehicle.joint_sign
        )
        self._vehicle, self._coupling = vehicle, settings.coupling
        self._times = sample_time * np.arange(settings.horizon + 1)

    def _fill(self, estimate: Estimate, reference: BodyReference, neighbour: BodyPlan | None) -> None:
        solver = self.solver
        solver.initial[:] = estimate.tractor.yaw - estimate.trailer.yaw, estimate.trailer_steering
        solver.p[:, :4] = (
            estimate.longitudinal_slip,
            estimate.tractor_crab,
            estimate.trailer_crab,
            estimate.speed,
        )
        if self._coupling is Coupling.PLANNED and neighbour is not None:
            rates = np.diff(neighbour.poses[:, 2]) / self._times[1]
            solver.p[:-1, 4], solver.p[-1, 4] = rates, rates[-1]
            solver.p[:, 5:8] = neighbour.poses
        else:
            self._assume_tractor(estimate)
        solver.p[:, 8:] = reference.samples[:, :3]

    def _assume_tractor(self, estimate: Estimate) -> None:
        """Let the tractor keep its present yaw rate (measured coupling), or go straight (neglected)."""
        p, pose, crab = self.solver.p, estimate.tractor, estimate.tractor_crab
        speed = estimate.longitudinal_slip * estimate.speed
        omega = 0.0
        if self._coupling is not Coupling.NEGLECTED:
            angle = estimate.tractor_slip * estimate.tractor_steering + estimate.steering_offset
            omega = speed * (math.tan(angle) - math.tan(crab)) / self._vehicle.wheelbase
        half = 0.5 * omega * self._times
        chord = speed / math.cos(crab) * self._times * np.sinc(half / math.pi)
        direction = half + (pose.yaw + crab)
        p[:, 4] = omega
        p[:, 5] = pose.x + chord * np.cos(direction)
        p[:, 6] = pose.y + chord * np.sin(direction)
        p[:, 7] = pose.yaw + 2.0 * half

    def _steering(self) -> float:
        return self._actuator.command(float(self.solver.initial[1]), float(self.solver.u[0, 0]))

    def _steerings(self) -> Floats:
        return self.solver.x[1:, 1].copy()

    def _poses(self) -> Floats:
        vehicle, p, x = self._vehicle, self.solver.p, self.solver.x
        theta, psi = p[:, 7], p[:, 7] - x[:, 0]
        phi = psi + x[:, 1]
        a, d, back = (
            vehicle.free_joint_offset,
            vehicle.drawbar_length,
            vehicle.trailer_length - vehicle.trailer_antenna,
        )
        east = p[:, 5] - a * np.cos(theta) - d * np.cos(phi) - back * np.cos(psi)
        north = p[:, 6] - a * np.sin(theta) - d * np.sin(phi) - back * np.sin(psi)
        return np.column_stack((east, north, psi))


def _steering_bounds(limit: float, rate: float) -> dict[str, Bound]:
    return {
        "steering": Bound(lower=-limit, upper=limit, linear_penalty=_OVERSTEER),
        "steering_rate": Bound(lower=-rate, upper=rate),
    }
