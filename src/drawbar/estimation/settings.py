"""The estimator section of a configuration: standard deviations only; weights are derived from them."""

import math
from typing import Literal, Self

from pydantic import model_validator

from drawbar.settings import Horizon, NonNegative, NonNegativeAngle, Positive, PositiveAngle, Settings, Share

Method = Literal["moving_horizon", "extended_kalman"]
"""Over a window with bounds, or recursively with clipping to the bounds"""


class SlipBounds(Settings):
    """Range of a slip factor."""

    lower: Share
    upper: Positive

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if not self.lower < self.upper:
            raise ValueError(f"lower = {self.lower} must be below upper = {self.upper}; exchange them")
        return self

    def require(self, first_slip: float) -> None:
        """Refuse a first guess outside the range by a ValueError."""
        if not self.lower <= first_slip <= self.upper:
            raise ValueError(f"first_slip = {first_slip} must be within {self.lower} .. {self.upper}")


class TricyclePrior(Settings):
    """What is known of states and parameters when the estimator starts, standard deviations."""

    position: Positive = 0.1
    """m"""
    yaw: PositiveAngle = 0.3
    """rad"""
    slip: Positive = 0.1
    """of mu, kappa and eta"""
    hitch_angle: PositiveAngle = 0.1
    """rad"""
    speed: Positive = 0.2
    """m/s"""


class TricycleDrift(Settings):
    """Process noise per sample, standard deviations; the paper's D_update read as variances."""

    position: NonNegative = math.sqrt(10.0)
    """m"""
    yaw: NonNegativeAngle = math.sqrt(0.1)
    """rad"""
    slip: NonNegative = math.sqrt(0.25)
    """of mu, kappa and eta"""
    hitch_angle: NonNegativeAngle = math.sqrt(0.1745)
    """rad"""
    speed: NonNegative = math.sqrt(0.1)
    """m/s"""


class TricycleEstimatorSettings(Settings):
    """Moving horizon estimation on the paper's model (section IV-A)."""

    model: Literal["tricycle"]
    method: Method = "moving_horizon"
    window: Horizon = 15
    """N, samples in the window besides the newest; 3 s at 5 Hz"""
    weighting: Literal["paper", "statistical"] = "paper"
    """H = diag(sigma)^-1 as printed, or diag(sigma)^-2 as least squares wants it"""
    first_slip: Positive = 0.9
    """first guess of mu, kappa and eta"""
    prior: TricyclePrior = TricyclePrior()
    drift: TricycleDrift = TricycleDrift()
    slip_bounds: SlipBounds = SlipBounds(lower=0.25, upper=1.0)
    """of mu, kappa and eta"""

    @model_validator(mode="after")
    def _first_slip_allowed(self) -> Self:
        self.slip_bounds.require(self.first_slip)
        return self

    def bounds_by_estimate(self) -> dict[str, tuple[float, float]]:
        """Return the bounds by the name that Estimate gives each parameter."""
        slip = (self.slip_bounds.lower, self.slip_bounds.upper)
        return dict.fromkeys(("longitudinal_slip", "tractor_slip", "trailer_slip"), slip)


class ArticulatedPrior(Settings):
    """What is known of states and parameters when the estimator starts, standard deviations."""

    position: Positive = 0.1
    """m"""
    yaw: PositiveAngle = 0.3
    """of both bodies, rad"""
    steering: PositiveAngle = 0.05
    """of both steering angles, rad"""
    longitudinal_slip: Positive = 0.1
    """mu"""
    tractor_slip: Positive = 0.1
    """kappa"""
    steering_offset: PositiveAngle = 0.02
    """b, rad"""
    crab: PositiveAngle = 0.02
    """of both axles, rad"""
    speed: Positive = 0.2
    """m/s"""


class ArticulatedDrift(Settings):
    """Process noise per sample, standard deviations."""

    position: NonNegative = 0.004
    """m"""
    yaw: NonNegativeAngle = 0.002
    """of both bodies, rad"""
    steering: NonNegativeAngle = 1e-4
    """of both steering angles, on top of the steering rates, rad"""
    longitudinal_slip: NonNegative = 0.01
    """mu"""
    tractor_slip: NonNegative = 0.002
    """kappa"""
    steering_offset: NonNegativeAngle = 0.0002
    """b, rad"""
    crab: NonNegativeAngle = 0.002
    """of both axles, rad"""
    speed: NonNegative = 0.02
    """m/s"""


class ArticulatedEstimatorSettings(Settings):
    """Moving horizon estimation on the exact chain."""

    model: Literal["articulated"]
    method: Method = "moving_horizon"
    window: Horizon = 15
    """N, samples in the window besides the newest; 3 s at 5 Hz"""
    steering_rate: PositiveAngle = 0.15
    """standard deviation of both steering rates within a sample, rad/s"""
    first_slip: Positive = 0.9
    """first guess of mu and kappa"""
    prior: ArticulatedPrior = ArticulatedPrior()
    drift: ArticulatedDrift = ArticulatedDrift()
    longitudinal_slip_bounds: SlipBounds = SlipBounds(lower=0.25, upper=1.0)
    """mu"""
    tractor_slip_bounds: SlipBounds = SlipBounds(lower=0.5, upper=1.1)
    """kappa"""
    angle_bound: PositiveAngle = 0.15
    """largest |b|, |alpha_r| and |alpha_i|, rad"""

    @model_validator(mode="after")
    def _first_slip_allowed(self) -> Self:
        self.longitudinal_slip_bounds.require(self.first_slip)
        self.tractor_slip_bounds.require(self.first_slip)
        return self

    def bounds_by_estimate(self) -> dict[str, tuple[float, float]]:
        """Return the bounds by the name that Estimate gives each parameter."""
        angle = (-self.angle_bound, self.angle_bound)
        return {
            "longitudinal_slip": (self.longitudinal_slip_bounds.lower, self.longitudinal_slip_bounds.upper),
            "tractor_slip": (self.tractor_slip_bounds.lower, self.tractor_slip_bounds.upper),
            "steering_offset": angle,
            "tractor_crab": angle,
            "trailer_crab": angle,
        }


class IdealEstimatorSettings(Settings):
    """The simulated machine's true state in place of an estimate: the upper limit of what estimation can give."""

    model: Literal["ideal"]

    def bounds_by_estimate(self) -> dict[str, tuple[float, float]]:
        """Return no bounds: nothing is estimated."""
        return {}
