"""How one vehicle model serves an estimator: its problem, its first guess, its way to an Estimate."""

import math
from abc import ABC, abstractmethod

from drawbar.errors import HardwareError
from drawbar.estimation.antennas import Antennas, Point
from drawbar.estimation.settings import ScreeningSettings
from drawbar.geometry import Floats, nearest_branch
from drawbar.optimal import EstimationProblem
from drawbar.signals import Command, Estimate, Measurement, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters


class EstimationModel(ABC):
    """The model-specific part of estimation; the filter or window around it is the same for every model."""

    problem: EstimationProblem
    screening: ScreeningSettings
    position_deviation: float
    """standard deviation of one coordinate of a fix, m"""
    first_yaw_error: float
    """added to the first guess of both yaws, rad"""
    yaws: tuple[int, int]
    """rows of the tractor's and the trailer's yaw in the state"""

    def first_guess(self, measurement: Measurement) -> Floats:
        """Return states and parameters (nx + np,) from the first measurement, both yaws off by the configured error.

        Raises:
            HardwareError: the first measurement lacks a position.
        """
        guess = self.at_rest(measurement)
        guess[list(self.yaws)] += self.first_yaw_error
        return guess

    def new_guess(self, measurement: Measurement, state: Floats) -> Floats:
        """Return states and parameters (nx + np,) from a later measurement, yaws on the branch of the present state.

        Raises:
            HardwareError: the measurement lacks a position.
        """
        guess, tractor = self.at_rest(measurement), self.yaws[0]
        guess[list(self.yaws)] += nearest_branch(guess[tractor], state[tractor]) - guess[tractor]
        return guess

    @abstractmethod
    def at_rest(self, measurement: Measurement) -> Floats:
        """Return the states and parameters (nx + np,) at rest that explain one measurement.

        Raises:
            HardwareError: the measurement lacks a position.
        """

    @abstractmethod
    def antennas(self, state: list[float]) -> Antennas:
        """Return where both antennas are in a state (nx + np,)."""

    @abstractmethod
    def steering_rates(self, state: list[float], command: Command) -> tuple[float, ...]:
        """Return the rates that a command from now on gives the steering, rad/s, as the values of the last outputs.

        Empty for a model whose inputs are measured.
        """

    @abstractmethod
    def outputs(self, measurement: Measurement) -> tuple[float, ...]:
        """Return the measurement in the order of the model's outputs, NaN where missing."""

    @abstractmethod
    def estimate(self, state: list[float], measurement: Measurement, status: SolverStatus) -> Estimate:
        """Return the Estimate that a state vector (nx + np,) stands for."""


def measured(measurement: Measurement) -> tuple[float, ...]:
    """Return the eight measured quantities in the order of both models' outputs; what is not finite is missing."""
    values = (
        measurement.tractor_x,
        measurement.tractor_y,
        measurement.trailer_x,
        measurement.trailer_y,
        measurement.hitch_angle,
        measurement.speed,
        measurement.tractor_steering,
        measurement.trailer_steering,
    )
    return tuple(value if math.isfinite(value) else math.nan for value in values)


def known(value: float) -> float:
    """Return the measured value, or zero where it is missing or no number: the first guess has nothing better."""
    return value if math.isfinite(value) else 0.0


def trailer_antenna(vehicle: VehicleParameters, x: float, y: float, theta: float, phi: float, psi: float) -> Point:
    """Return the trailer antenna's position (m) behind a rear axle at x, y (m); yaws of tractor, drawbar, trailer."""
    a, d = vehicle.free_joint_offset, vehicle.drawbar_length
    back = vehicle.trailer_length - vehicle.trailer_antenna
    return (
        x - a * math.cos(theta) - d * math.cos(phi) - back * math.cos(psi),
        y - a * math.sin(theta) - d * math.sin(phi) - back * math.sin(psi),
    )


def yaws_at_rest(vehicle: VehicleParameters, measurement: Measurement) -> tuple[float, float]:
    """Return tractor and trailer yaw (rad) from both antennas and both joint angles.

    The vector from the trailer's antenna to the tractor's has known length and direction in the trailer's frame once
    the joint angles are known, so one measurement at rest shows the heading.

    Raises:
        HardwareError: a position is missing.
    """
    east, north = measurement.tractor_x - measurement.trailer_x, measurement.tractor_y - measurement.trailer_y
    if not math.isfinite(east + north):
        raise HardwareError(
            f"The first measurement lacks a position (tractor {measurement.tractor_x}, {measurement.tractor_y}; "
            f"trailer {measurement.trailer_x}, {measurement.trailer_y}); wait for a fix of both antennas to start."
        )
    hitch, joint = known(measurement.hitch_angle), known(measurement.trailer_steering)
    gamma = hitch + joint
    back = vehicle.trailer_length - vehicle.trailer_antenna
    ahead = back + vehicle.drawbar_length * math.cos(joint) + vehicle.free_joint_offset * math.cos(gamma)
    left = vehicle.drawbar_length * math.sin(joint) + vehicle.free_joint_offset * math.sin(gamma)
    trailer = math.atan2(north, east) - math.atan2(left, ahead)
    return trailer + gamma, trailer
