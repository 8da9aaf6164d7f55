"""Uncertainty of an estimate: how well it is known where both bodies are across the line and which way they face."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from drawbar.config import Configuration
from drawbar.estimation.deviation import newest_covariance
from drawbar.estimation.settings import ArticulatedEstimatorSettings
from drawbar.geometry import Floats
from drawbar.signals import Estimate
from drawbar.step.autopilot import Autopilot
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.parameters import VehicleParameters


@dataclass(frozen=True, slots=True, kw_only=True)
class Uncertainty:
    """Standard deviations of an estimate; NaN, or none, where they are not known."""

    lateral: float = math.nan
    """of the position across the body, the larger of both bodies', m"""
    heading: float = math.nan
    """of the yaw, the larger of both bodies', rad"""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """of the estimate's fields of these names, slips and angles, each in its own unit"""


def uncertainty_of(autopilot: Autopilot, configuration: Configuration) -> Callable[[Estimate], Uncertainty]:
    """Return what computes the uncertainty of the newest estimate; to be asked between the two phases of a step.

    Nothing is known with an estimator that keeps no covariance of the whole chain.
    """
    settings, vehicle = configuration.estimator, configuration.vehicle
    if not isinstance(settings, ArticulatedEstimatorSettings):
        return lambda estimate: Uncertainty()
    chain = articulated(vehicle)
    names = [variable.name for variable in chain.parameters]
    estimator = autopilot.library.components["estimator"].live

    def covariance() -> Floats:
        if settings.method != "extended_kalman":
            return newest_covariance(estimator)
        root = estimator.array("filter.R")  # of the covariance: the transpose of a square root
        return np.asarray(root.T @ root)

    def tell(estimate: Estimate) -> Uncertainty:
        found = covariance()
        deviations = np.sqrt(np.diag(found)[len(chain.states) :]).tolist()
        lateral, heading = lateral_and_heading(vehicle, estimate, found)
        parameters = dict(zip(names, deviations, strict=True))
        return Uncertainty(lateral=lateral, heading=heading, parameters=parameters)

    return tell


def lateral_and_heading(vehicle: VehicleParameters, estimate: Estimate, covariance: Floats) -> tuple[float, float]:
    """Return standard deviations across the bodies (m) and of their yaws (rad), the larger of both.

    Args:
        vehicle: its lengths.
        estimate: of the chain.
        covariance: (n, n), whose first states are x, y, yaw of the tractor, yaw of the trailer, both steering angles.
    """
    theta, psi = estimate.tractor.yaw, estimate.trailer.yaw
    phi = psi + estimate.trailer_steering
    drawbar, back = vehicle.drawbar_length, vehicle.trailer_length - vehicle.trailer_antenna

    def turned(yaw: float, length: float) -> Floats:
        """How a point that lies `length` behind moves as yaw grows."""
        return length * np.array([math.sin(yaw), -math.cos(yaw)])

    moves = np.zeros((2, len(covariance)))  # of the trailer's antenna
    moves[:, :2] = np.eye(2)
    moves[:, 2] = turned(theta, vehicle.free_joint_offset)
    moves[:, 3] = turned(phi, drawbar) + turned(psi, back)
    moves[:, 5] = turned(phi, drawbar)
    trailer = moves @ covariance @ moves.T
    lateral = [_sideways(psi, trailer), _sideways(theta, covariance[:2, :2])]
    return math.sqrt(max(lateral)), math.sqrt(max(covariance[2, 2], covariance[3, 3]))


def _sideways(yaw: float, covariance: Floats) -> float:
    left = np.array([-math.sin(yaw), math.cos(yaw)])
    return float(left @ covariance @ left)
