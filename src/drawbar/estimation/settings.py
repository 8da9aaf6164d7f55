"""The estimator section of a configuration: standard deviations only; weights are derived from them."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drawbar.settings import Angle, Horizon, NonNegative, NonNegativeAngle, Positive, PositiveAngle, Settings, Share

DRIFT_TIME = 0.2
"""time over which `drift` states process noise, s"""

Method = Literal["moving_horizon", "extended_kalman"]
"""Over a window with bounds, or recursively with clipping to the bounds"""


class SlipBounds(Settings):
    """Range of a slip factor."""

    lower: Share
    """smallest that the estimate may be"""
    upper: Positive
    """largest that the estimate may be"""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if not self.lower < self.upper:
            raise ValueError(f"lower = {self.lower} must be below upper = {self.upper}; exchange them")
        return self

    def require(self, first_slip: float) -> None:
        """Refuse a first guess outside the range by a ValueError."""
        if not self.lower <= first_slip <= self.upper:
            raise ValueError(f"first_slip = {first_slip} must be within {self.lower} .. {self.upper}")


class ScreeningSettings(Settings):
    """Which position fixes are masked before the estimator sees them (docs/theory/screening.md).

    A deviation is that of one coordinate: `sensors.position`, or what the fixes show where that is more.
    """

    lateral: Positive = 4.0
    """furthest that a fix may lie from its prediction across the vehicle, deviations"""
    longitudinal: Positive = 0.5
    """the same along the vehicle, m: hard acceleration takes both antennas ahead of their predictions"""
    growth: NonNegative = 0.1
    """by how much both grow while neither antenna has a fix, m/s: dead reckoning loses its way"""
    single_growth: NonNegative = 0.0
    """by how much an antenna's own grow while it has no fix, m/s: for models that do not tie the antennas together.
    Unless it is zero, fixes are not moved by what the antennas' distance is wrong"""
    shift: Positive = 2.3
    """mean disagreement of the antennas about where the vehicle is that makes one suspect, deviations"""
    release: Positive = 1.7
    """mean difference below which a suspicion ends, standard deviations"""
    memory: Annotated[int, Field(ge=1)] = 5
    """samples over which the disagreement is averaged"""
    long_memory: Annotated[int, Field(ge=1)] = 100
    """samples over which the deviation and the error of the antennas' distance (wrong lengths) are averaged"""
    late: NonNegative = 0.05
    """unreported latency of fixes, or lag of bodies behind their wheels, for which the gates widen while speed or yaw
    rate change, s"""
    settling: Annotated[int, Field(ge=1)] = 13
    """samples in which the estimator compensates such a change"""
    length: Positive = 0.2
    """largest change of the antennas' distance with which they still agree with each other; across the vehicle
    one may be off as seen from the other by as much besides the gate, m"""
    hitch: PositiveAngle = 0.15
    """furthest that the hitch angle may be from its prediction, rad"""
    steering: PositiveAngle = 0.2
    """by how much a steering angle may change from one sample to the next before a second one must confirm it, rad"""
    speed: Positive = 1.0
    """the same of the speed, m/s"""
    repetition: Positive = 0.05
    """a fix that repeats exactly while the vehicle moved by more than this is stale, m"""
    patience: Positive = 1.0
    """time for which both antennas must agree with each other against the estimate to overrule it, and for which they
    must first have confirmed it: before that, two samples in a row are enough, s"""

    @model_validator(mode="after")
    def _release_below_shift(self) -> Self:
        if not self.release <= self.shift:
            raise ValueError(f"release = {self.release} must not be above shift = {self.shift}; lower it")
        return self


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
    """over a window with bounds, or recursively with clipping to the bounds"""
    window: Horizon = 15
    """N, samples in the window besides the newest; 3 s at 5 Hz"""
    weighting: Literal["paper", "statistical"] = "paper"
    """H = diag(sigma)^-1 as printed, or diag(sigma)^-2 as least squares wants it"""
    first_slip: Positive = 0.9
    """first guess of mu, kappa and eta"""
    first_yaw_error: Angle = 0.0
    """added to the first guess of both yaws, to see the estimator recover, rad"""
    screening: ScreeningSettings = ScreeningSettings(
        lateral=10.0, single_growth=0.1, shift=30.0, release=30.0, hitch=math.pi
    )
    """wide: nothing ties the two antennas of this model together, so neither can vouch for the other"""
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
    speed: Positive = 0.5
    """m/s"""


class ArticulatedDrift(Settings):
    """Process noise over 0.2 s, standard deviations; over another sample time it grows with its square root."""

    position: NonNegative = 0.003
    """m"""
    yaw: NonNegativeAngle = 0.001
    """of both bodies, rad"""
    steering: NonNegativeAngle = 1e-4
    """of both steering angles, on top of the steering rates, rad"""
    longitudinal_slip: NonNegative = 0.01
    """mu"""
    tractor_slip: NonNegative = 0.003
    """kappa"""
    steering_offset: NonNegativeAngle = 0.0005
    """b, rad"""
    crab: NonNegativeAngle = 0.001
    """of both axles, each by itself, rad"""
    slope: NonNegativeAngle = 0.0013
    """of both axles and the steering offset together, as a side slope moves them, rad"""
    speed: NonNegative = 0.1
    """m/s"""


class SlideSettings(Settings):
    """What is found of the direction in which a slope draws all axles (slide.h), standard deviations."""

    prior: Annotated[NonNegativeAngle, Field(lt=0.2)] = 0.03
    """of the slide to the east and to the north at first; 0: none is looked for, rad"""
    walk: NonNegativeAngle = 2e-4
    """by which they may change per sample, rad"""
    beyond_slope: PositiveAngle = 0.01
    """of the slide at first, beyond what the creep makes of a slope that an attitude sensor shows, rad"""
    creep_prior: Annotated[float, Field(ge=0.0, le=1.0)] = 0.3
    """of the side-slip per side acceleration, of a slope or a curve, at first, and of the curve's beyond that of the
    slope, rad/g; 0: none is looked for"""
    constant_prior: PositiveAngle = 0.015
    """of what is the same in all headings, such as an antenna that stands 10 cm further aside than stated, 5 m from
    the other, rad"""
    noise: PositiveAngle = 0.12
    """of one estimated side-slip, which is much like the one before, without an attitude sensor; half as much with one,
    rad"""


class ArticulatedEstimatorSettings(Settings):
    """Moving horizon estimation on the exact chain."""

    model: Literal["articulated"]
    method: Method = "moving_horizon"
    """over a window with bounds, or recursively with clipping to the bounds"""
    window: Horizon = 6
    """N, samples in the window besides the newest; 1.2 s at 5 Hz; why no more: docs/theory/estimation.md"""
    steering_rate: PositiveAngle = 0.06
    """standard deviation of both steering rates from what the last command asks of lag and rate limit, rad/s"""
    crab: PositiveAngle = 0.1
    """standard deviation with which each sample that lacks a fix takes both crab angles for zero, rad; with
    drift.crab and drift.slope it sets how soon an angle that nothing shows any more is forgotten: within some
    crab / hypot(drift.crab, drift.slope) samples at 5 Hz"""
    first_slip: Positive = 0.9
    """first guess of mu and kappa"""
    first_yaw_error: Angle = 0.0
    """added to the first guess of both yaws, to see the estimator recover, rad"""
    screening: ScreeningSettings = ScreeningSettings()
    prior: ArticulatedPrior = ArticulatedPrior()
    drift: ArticulatedDrift = ArticulatedDrift()
    slide: SlideSettings = SlideSettings()
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
