"""The controller and tube sections of a configuration."""

from enum import StrEnum
from typing import Annotated, Literal

from pydantic import Field

from drawbar.settings import Horizon, NonNegative, Positive, Settings


class Coupling(StrEnum):
    """What the trailer's controller knows of the tractor's motion (g_2 in equation nonlinearmodel)."""

    NEGLECTED = "neglected"
    """nothing: g_2 = 0, as in the paper"""
    MEASURED = "measured"
    """computed from local measurements and held over the horizon; no exchange between controllers"""
    PLANNED = "planned"
    """the tractor controller's plan; distributed"""


CouplingSetting = Annotated[Coupling, Field(strict=False)]


Structure = Literal["decentralised", "centralised"]
"""One small problem for each body, or one large problem for both (the paper's CeNMPC)"""


class TricycleControllerSettings(Settings):
    """The paper's nominal controllers (section IV-B): weights on position and on the change of steering."""

    model: Literal["tricycle"]
    structure: Structure = "decentralised"
    horizon: Horizon = 20
    """N, samples"""
    coupling: CouplingSetting = Coupling.NEGLECTED
    position_weight: NonNegative = 1.0
    """Q, 1/m²"""
    steering_weight: Positive = 10.0
    """R, on the distance to the last measured steering, 1/rad²"""
    terminal_weight: NonNegative = 10.0
    """S, on the position at the end of the horizon, 1/m²"""


class ArticulatedTractorWeights(Settings):
    """Weights of the tractor's stage cost."""

    lateral: Positive = 40.0
    """1/m²"""
    heading: NonNegative = 1.0
    """1/rad²"""
    steering: NonNegative = 0.1
    """on the distance to the curvature feed-forward, 1/rad²"""
    steering_rate: Positive = 0.3
    """s²/rad²"""


class ArticulatedTrailerWeights(Settings):
    """Weights of the trailer's stage cost."""

    lateral: Positive = 40.0
    """1/m²"""
    steering: NonNegative = 0.002
    """1/rad²"""
    steering_rate: Positive = 1.0
    """s²/rad²"""


class ArticulatedControllerSettings(Settings):
    """The product's nominal controllers: lateral errors along a preview of the path."""

    model: Literal["articulated"]
    structure: Structure = "decentralised"
    horizon: Horizon = 20
    """N, samples"""
    coupling: CouplingSetting = Coupling.MEASURED
    widening: NonNegative = 0.05
    """how far the tractor keeps outside a curve per curvature, m²: 5 mm at 0.1 1/m, since the trailer's
    steering is exhausted there and cannot stop cutting in by itself"""
    tractor: ArticulatedTractorWeights = ArticulatedTractorWeights()
    trailer: ArticulatedTrailerWeights = ArticulatedTrailerWeights()


class TrailerProportionalIntegral(Settings):
    """The textbook's way to steer a trailer: PI on its lateral error. Both gains zero: the joint is held straight."""

    proportional: NonNegative = 0.0
    """rad/m"""
    integral: NonNegative = 0.0
    """rad/(m s)"""


class PurePursuitSettings(Settings):
    """Pure pursuit (Coulter 1992) for the tractor, a PI controller on the lateral error for the trailer."""

    model: Literal["pure_pursuit"]
    horizon: Horizon = 20
    """samples of the path ahead that the guidance hands over; the look-ahead point must lie within"""
    look_ahead: Positive = 1.6
    """distance of the pursued point, m"""
    trailer: TrailerProportionalIntegral = TrailerProportionalIntegral()


class LqrSettings(Settings):
    """Linear quadratic regulator of the tractor in path coordinates, PI on the lateral error for the trailer."""

    model: Literal["lqr"]
    horizon: Horizon = 20
    """samples of the path ahead that the guidance hands over"""
    lateral: Positive = 1.0
    """weight of the lateral error, 1/m²"""
    heading: NonNegative = 1.0
    """weight of the heading error, 1/rad²"""
    steering: Positive = 1.0
    """weight of the steering beyond the curvature's, 1/rad²"""
    trailer: TrailerProportionalIntegral = TrailerProportionalIntegral()


class AncillaryGain(Settings):
    """One body's K: steering per error of the pose against its prediction, in the predicted heading's frame."""

    lateral: float = 0.0
    """rad/m"""
    yaw: float = 0.0
    """rad/rad"""


class TubeSettings(Settings):
    """The ancillary law u = ū + K (x - x̄) with x̄ the prediction made one sample ago; no gains, no law."""

    tractor: AncillaryGain = AncillaryGain()
    trailer: AncillaryGain = AncillaryGain()
