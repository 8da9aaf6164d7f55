"""Controllers in closed form, to compare with: a steering law for the tractor, a PI controller for the trailer."""

import math
from abc import abstractmethod

import numpy as np

from drawbar.control.nominal import NO_SOLVER, NominalController
from drawbar.control.settings import TrailerProportionalIntegral
from drawbar.geometry import Floats
from drawbar.signals import BodyPlan, BodyReference, Estimate, Plan, Pose, Reference, SolverStatus, SolveTimes
from drawbar.vehicle.parameters import VehicleParameters


class ExplicitController(NominalController):
    """Steers both bodies without a prediction; the plan says what would follow if the command were held.

    The predicted tractor rolls on at constant speed and curvature, the bicycle's; the predicted trailer is on its
    reference.
    """

    def __init__(self, vehicle: VehicleParameters, trailer: TrailerProportionalIntegral, sample_time: float) -> None:
        """Take the vehicle, the trailer's gains and the sample time, s."""
        self._vehicle, self._interval = vehicle, sample_time
        self._trailer = ProportionalIntegral(trailer, limit=vehicle.trailer_steering_limit, sample_time=sample_time)

    @abstractmethod
    def _steering(self, estimate: Estimate, reference: BodyReference) -> float:
        """Return the tractor's steering before its limit, rad."""

    def feedback(self, estimate: Estimate, reference: Reference) -> Plan:
        """Return both bodies' commands and what would follow from them."""
        vehicle = self._vehicle
        steering = clipped(self._steering(estimate, reference.tractor), vehicle.tractor_steering_limit)
        joint = self._trailer.output(lateral_error(estimate.trailer, reference.trailer))
        poses = self._roll_out(estimate, steering, len(reference.tractor.samples))
        return Plan(
            time=estimate.time,
            tractor=_plan(steering, steering, poses),
            trailer=_plan(vehicle.joint_sign * joint, joint, reference.trailer.samples[:, :3].copy()),
        )

    def prepare(self) -> None:
        """Do nothing: the laws need no preparation."""

    @property
    def times(self) -> tuple[SolveTimes, SolveTimes]:
        """NaN: nothing is solved."""
        return NO_SOLVER, NO_SOLVER

    def _roll_out(self, estimate: Estimate, steering: float, count: int) -> Floats:
        """Return the tractor's poses (count, 3) on the arc that the steering (rad) means, one per sample."""
        pose = estimate.tractor
        distance = estimate.longitudinal_slip * estimate.speed * self._interval * np.arange(count)
        half = 0.5 * distance * math.tan(steering) / self._vehicle.wheelbase
        chord, direction = distance * np.sinc(half / math.pi), pose.yaw + half
        x, y = pose.x + chord * np.cos(direction), pose.y + chord * np.sin(direction)
        return np.stack([x, y, pose.yaw + 2.0 * half], axis=1)


class ProportionalIntegral:
    """PI on the trailer's lateral error; both gains zero hold the joint straight.

    A positive joint angle shifts the trailer to the right, so an error to the left wants a positive one. While the
    output would pass its limit the integral rests (conditional integration, Åström and Hägglund 1995, section 3.5); so
    it never holds more than the limit, and gives way as soon as the error changes its sign.
    """

    def __init__(self, gains: TrailerProportionalIntegral, *, limit: float, sample_time: float) -> None:
        """Take the gains, the largest output (rad) and the sample time, s."""
        self._gains, self._limit, self._interval = gains, limit, sample_time
        self._integral = 0.0

    def output(self, error: float) -> float:
        """Return the joint angle for this lateral error (m, left positive), rad."""
        integral = self._integral + self._gains.integral * self._interval * error
        wanted = self._gains.proportional * error + integral
        if abs(wanted) <= self._limit:
            self._integral = integral
        return clipped(wanted, self._limit)


def lateral_error(pose: Pose, reference: BodyReference) -> float:
    """Return the distance of a body from the tangent of its reference where it is now, left positive, m."""
    x, y, yaw, _ = map(float, reference.samples[0])
    return math.cos(yaw) * (pose.y - y) - math.sin(yaw) * (pose.x - x)


def clipped(angle: float, limit: float) -> float:
    """Return the angle within ±limit; one that is not finite stays, for the gate to refuse."""
    return min(max(angle, -limit), limit) if math.isfinite(angle) else angle


def _plan(command: float, steering: float, poses: Floats) -> BodyPlan:
    steerings = np.full(len(poses) - 1, steering)
    return BodyPlan(steering=command, poses=poses, steerings=steerings, status=SolverStatus.SOLVED)
