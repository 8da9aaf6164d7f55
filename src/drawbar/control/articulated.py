"""The product's two nominal controllers: lateral errors of both antennas along a preview of the path."""

import cmath
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

    def _guess(self, reference: BodyReference) -> None:
        """Linearise along the path itself, steered as its curvature asks."""
        solver = self.solver
        solver.x[:, :3], solver.x[:, 3], solver.u[:] = reference.samples[:, :3], solver.y[:, 2], 0.0
        solver.x[0] = solver.initial
        solver.prepare()

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
        self._interval = sample_time
        self._times = sample_time * np.arange(settings.horizon + 1)
        self._imaginary_times = 1j * self._times[:-1]
        back = vehicle.trailer_length - vehicle.trailer_antenna
        self._back = -np.array([vehicle.free_joint_offset, vehicle.drawbar_length, back], complex)
        self._angles = np.zeros((3, settings.horizon + 1), complex)

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
            rates = np.diff(neighbour.poses[:, 2]) / self._interval
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
        return self._actuator.command(float(self.solver.initial[1]), float(self.solver.u[0, 0]))

    def _steerings(self) -> Floats:
        return self.solver.x[1:, 1].copy()

    def _poses(self) -> Floats:
        p, x = self.solver.p, self.solver.x
        poses = np.empty((len(p), 3))
        theta, psi, angles = p[:, 7], np.subtract(p[:, 7], x[:, 0], out=poses[:, 2]), self._angles.imag
        angles[0], angles[1], angles[2] = theta, psi + x[:, 1], psi
        antenna = self._back @ np.exp(self._angles)
        poses[:, 0] = p[:, 5] + antenna.real
        poses[:, 1] = p[:, 6] + antenna.imag
        return poses


def _steering_bounds(limit: float, rate: float) -> dict[str, Bound]:
    return {
        "steering": Bound(lower=-limit, upper=limit, linear_penalty=_OVERSTEER),
        "steering_rate": Bound(lower=-rate, upper=rate),
    }
